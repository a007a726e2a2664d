// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/volume/ChooseGrids.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <numeric>

namespace tetvdb {

std::vector<std::size_t> chooseGrids(const std::vector<std::string>& all,
                                     const std::vector<std::string>& names,
                                     const std::string& path) {
  std::vector<std::size_t> chosen;
  if (names.empty()) {
    chosen.resize(all.size());
    std::iota(chosen.begin(), chosen.end(), std::size_t(0));
  }
  for (const std::string& name : names) {
    const auto found = std::find(all.begin(), all.end(), name);
    if (found == all.end()) {
      std::string known;
      for (const std::string& one : all)
        known += (known.empty() ? "" : ", ") + one;
      throw Error(Status::Usage, "`grid`", path + " has no grid '" + name + "'",
                  "choose from " + known);
    }
    const auto index = static_cast<std::size_t>(found - all.begin());
    if (std::find(chosen.begin(), chosen.end(), index) != chosen.end())
      throw Error(Status::Usage, "`grid`", "'" + name + "' is named twice", "name every grid once");
    chosen.push_back(index);
  }
  return chosen;
}

} // namespace tetvdb
