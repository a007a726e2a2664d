// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/NeededArrays.h"

#include <string_view>

namespace tetvdb {

std::vector<std::string> neededArrays(const FieldOptions& fields, const Warp& warp) {
  if (fields.all)
    return {};
  std::vector<std::string> names;
  const auto add = [&](std::string_view name) {
    names.emplace_back(name);
    for (const char mark : {':', '.'}) // before the name of a part
      if (const auto at = name.rfind(mark); at != std::string_view::npos && at > 0)
        names.emplace_back(name.substr(0, at));
  };
  const auto addAny = [&](std::string_view name) {
    add(name);
    for (const std::string_view prefix : {"points:", "cells:"})
      if (name.substr(0, prefix.size()) == prefix)
        add(name.substr(prefix.size()));
  };
  for (const FieldRequest& request : fields.requests)
    addAny(request.array);
  if (!warp.array.empty())
    addAny(warp.array);
  return names;
}

} // namespace tetvdb
