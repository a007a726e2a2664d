// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/volume/Volume.h"

#include <algorithm>
#include <cstddef>

namespace tetvdb {

/// Adds the counts of one part of a grid, its box and its range of values to those of the whole;
/// `base`: those of the grid without voxels. The volume is left out.
inline void addCounts(const GridInfo& part, const GridInfo& base, GridInfo& sum) {
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
