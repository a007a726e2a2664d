// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/HostDevice.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// Corner k of the face opposite corner `face` of a tet; for a positive tet these are
/// counter-clockwise seen from outside.
TETVDB_HD constexpr int outwardCorner(int face, int k) {
  constexpr int corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  return corners[face][k];
}

/// As outwardCorner(), with the face reversed: its normal points inward.
TETVDB_HD constexpr int inwardCorner(int face, int k) {
  return outwardCorner(face, k == 0 ? 0 : 3 - k);
}

/// outwardCorner() as a table.
constexpr std::array<std::array<std::uint8_t, 3>, 4> kFaceCorners = [] {
  std::array<std::array<std::uint8_t, 3>, 4> table{};
  for (std::size_t face = 0; face < 4; ++face)
    for (std::size_t k = 0; k < 3; ++k)
      table[face][k] =
          static_cast<std::uint8_t>(outwardCorner(static_cast<int>(face), static_cast<int>(k)));
  return table;
}();

} // namespace tetvdb
