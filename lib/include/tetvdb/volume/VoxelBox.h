// SPDX-License-Identifier: Apache-2.0
//
// A box of voxels, in index space.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// Voxels low to high, both included; empty where high < low along an axis.
struct VoxelBox {
  Vec3i low{0, 0, 0};
  Vec3i high{-1, -1, -1};

  bool empty() const { return high[0] < low[0] || high[1] < low[1] || high[2] < low[2]; }
  std::uint64_t size(std::size_t axis) const {
    return empty()
               ? 0
               : static_cast<std::uint64_t>(static_cast<std::int64_t>(high[axis]) - low[axis]) + 1;
  }
  /// At most 2^96; the double is exact enough for limits.
  double voxels() const {
    return static_cast<double>(size(0)) * static_cast<double>(size(1)) *
           static_cast<double>(size(2));
  }
};

} // namespace tetvdb
