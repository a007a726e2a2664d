// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/volume/Volume.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tetvdb {

/// Adds the volume of one part of a grid to that of the whole. Whole numbers of voxels are summed
/// as such, so that the sum is that number times a voxel's volume, as without parts.
inline void addVolume(const GridInfo& part, GridInfo& sum) {
  const Vec3d& size = part.transform.voxelSize;
  const double voxel = size[0] * size[1] * size[2];
  const auto voxelsOf = [&](double volume) {
    const double voxels = volume / voxel, whole = std::round(voxels);
    return std::abs(voxels - whole) <= 1e-14 * whole ? whole : voxels;
  };
  sum.volume = (voxelsOf(sum.volume) + voxelsOf(part.volume)) * voxel;
}

/// Adds the counts of one part of a grid, its volume, its box and its range of values to those of
/// the whole; `base`: those of the grid without voxels.
inline void addCounts(const GridInfo& part, const GridInfo& base, GridInfo& sum) {
  addVolume(part, sum);
  sum.activeTiles += part.activeTiles;
  sum.leaves += part.leaves;
  sum.bytes += part.bytes - base.bytes;
  if (part.activeVoxels == 0)
    return;
  const bool first = sum.activeVoxels == 0;
  sum.activeVoxels += part.activeVoxels;
  for (std::size_t k = 0; k < 3; ++k) {
    sum.boxMin[k] = first ? part.boxMin[k] : std::min(sum.boxMin[k], part.boxMin[k]);
    sum.boxMax[k] = first ? part.boxMax[k] : std::max(sum.boxMax[k], part.boxMax[k]);
  }
  sum.minValue = first ? part.minValue : std::min(sum.minValue, part.minValue);
  sum.maxValue = first ? part.maxValue : std::max(sum.maxValue, part.maxValue);
}

} // namespace tetvdb
