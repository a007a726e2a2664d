// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/volume/Volume.h"

#include <algorithm>

namespace tetvdb {

/// Adds the comparison of one part of two grids to that of the other parts; keeps the name.
inline void add(GridComparison& sum, const GridComparison& part) {
  sum.activeA += part.activeA;
  sum.activeB += part.activeB;
  sum.activeBoth += part.activeBoth;
  sum.stateDiffers += part.stateDiffers;
  sum.valueDiffers += part.valueDiffers;
  sum.largestDifference = std::max(sum.largestDifference, part.largestDifference);
}

} // namespace tetvdb
