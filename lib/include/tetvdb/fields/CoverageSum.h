// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tetvdb {

/// What coverage() found; volumes in voxels.
struct CoverageSum {
  double filled = 0;               ///< the sum of all fractions before they are rounded to floats
  double overlap = 0;              ///< what fractions above 1 had more than 1: tets that overlap
  std::uint64_t overlapVoxels = 0; ///< voxels with such fractions
};

} // namespace tetvdb
