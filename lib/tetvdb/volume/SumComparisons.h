// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/volume/Volume.h"

#include <algorithm>

namespace tetvdb {

/// Adds the comparison of a part of two grids to that of other parts; the name stays.
inline void add(GridComparison& sum, const GridComparison& part) {
  sum.activeA += part.activeA;
  sum.activeB += part.activeB;
  sum.activeBoth += part.activeBoth;
  sum.stateDiffers += part.stateDiffers;
  sum.valueDiffers += part.valueDiffers;
  sum.largestDifference = std::max(sum.largestDifference, part.largestDifference);
}

} // namespace tetvdb
