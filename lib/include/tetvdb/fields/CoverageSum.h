// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tetvdb {

/// Sums computed by coverage(); volumes in voxels.
struct CoverageSum {
  double filled = 0;               ///< the sum of all fractions before they are rounded to floats
  double overlap = 0;              ///< sum of the excess of fractions above 1: overlapping tets
  std::uint64_t overlapVoxels = 0; ///< voxels with such fractions
};

} // namespace tetvdb
