// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace tetvdb {

/// The grids that can be made of any mesh, by the names that they have in a volume; every other
/// name is that of an array.
inline constexpr std::array<std::string_view, 7> kGridNames{"density",  "mask",   "surface", "fog",
                                                            "coverage", "tet_id", "material"};

/// "density, mask, ... and material".
inline std::string listGrids() {
  std::string text;
  for (std::size_t i = 0; i < kGridNames.size(); ++i)
    text.append(i == 0 ? "" : i + 1 < kGridNames.size() ? ", " : " and ").append(kGridNames[i]);
  return text;
}

} // namespace tetvdb
