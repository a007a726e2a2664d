// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/source/ReadOptions.h"

#include <algorithm>
#include <cstddef>

namespace tetvdb {

bool ReadOptions::wants(std::string_view name) const {
  if (!attributes)
    return false;
  constexpr std::size_t longestEnding = 3; // "_xx"
  return arrays.empty() ||
         std::any_of(arrays.begin(), arrays.end(), [&](const std::string& wanted) {
           return name.size() <= wanted.size() + longestEnding &&
                  name.substr(0, wanted.size()) == wanted;
         });
}

} // namespace tetvdb
