// SPDX-License-Identifier: Apache-2.0
//
// .vdb files whose grids are read part by part (io/volume/VdbChildren.h).
#pragma once

#include "tetvdb/io/volume/VdbHeader.h"
#include "tetvdb/volume/GridTypes.h"

#include <string>
#include <type_traits>
#include <vector>

namespace tetvdb {

/// Calls f(grid) with the known grid type of that name; false for others.
template <class F>
bool withGridOfType(const std::string& type, const F& f) {
  bool known = false;
  KnownGrids::foreach ([&](const auto& grid) {
    using GridT = std::decay_t<decltype(grid)>;
    if (!known && GridT::gridType() == type) {
      known = true;
      f(grid);
    }
  });
  return known;
}

/// The headers of a file that is whole; names are those that the grids were given. Throws
/// Error(Invalid), and Error(Usage) where canStreamVolume() is false.
VdbHeader checkedVdbHeader(const std::string& path);

/// Those grids that are named, in that order; without names all, by name. Throws Error(Usage) for
/// a name that the file does not have, or that comes twice.
std::vector<const VdbGridHeader*> chosenGrids(const VdbHeader& header, const std::string& path,
                                              const std::vector<std::string>& names);

} // namespace tetvdb
