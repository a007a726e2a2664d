// SPDX-License-Identifier: Apache-2.0
//
// Computes the boxes of the active voxels of nodes.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace tetvdb {

/// The first voxel of entry `entry` of the 128^3 node whose first voxel is `node`.
inline Vec3i leafOrigin(const Vec3i& node, std::size_t entry) {
  const auto i = static_cast<std::int32_t>(entry);
  return {node[0] + (i >> 8) * 8, node[1] + (i >> 4 & 15) * 8, node[2] + (i & 15) * 8};
}

struct VoxelBounds {
  Vec3i min{std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max(),
            std::numeric_limits<std::int32_t>::max()}; ///< inclusive
  Vec3i max{std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::min(),
            std::numeric_limits<std::int32_t>::min()};

  void add(const VoxelBounds& o) {
    for (std::size_t k = 0; k < 3; ++k) {
      min[k] = std::min(min[k], o.min[k]);
      max[k] = std::max(max[k], o.max[k]);
    }
  }
  /// A cube.
  void add(const Vec3i& origin, std::int32_t size) {
    for (std::size_t k = 0; k < 3; ++k) {
      min[k] = std::min(min[k], origin[k]);
      max[k] = std::max(max[k], origin[k] + size - 1);
    }
  }
  /// The voxels of a leaf whose bits are set, not none: eight words.
  void add(const Vec3i& origin, const std::uint64_t* words) {
    std::uint64_t yz = 0;
    std::int32_t x0 = 8, x1 = 0;
    for (std::int32_t x = 0; x < 8; ++x) {
      if (words[x] == 0)
        continue;
      x0 = std::min(x0, x);
      x1 = x;
      yz |= words[x];
    }
    std::uint64_t z = yz | yz >> 32;
    z |= z >> 16;
    z = (z | z >> 8) & 0xFF;
    const auto low = [](std::uint64_t word) {
      return static_cast<std::int32_t>(__builtin_ctzll(word));
    };
    const auto high = [](std::uint64_t word) {
      return 63 - static_cast<std::int32_t>(__builtin_clzll(word));
    };
    add({{origin[0] + x0, origin[1] + low(yz) / 8, origin[2] + low(z)},
         {origin[0] + x1, origin[1] + high(yz) / 8, origin[2] + high(z)}});
  }
  bool contains(const Vec3i& origin, std::int32_t size) const {
    for (std::size_t k = 0; k < 3; ++k)
      if (origin[k] < min[k] || origin[k] + size - 1 > max[k])
        return false;
    return true;
  }
};

} // namespace tetvdb
