// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

/// Volumes in world units cubed, by points spread evenly over the box around both meshes.
struct SolidComparison {
  std::size_t samples = 0, inside = 0; ///< points; within the first mesh or the second
  double before = 0, after = 0;        ///< where the winding number is above 0.5
  double lost = 0;     ///< where it is above 0.6 by the first and below 0.5 by the second
  double gained = 0;   ///< where it is below 0.4 by the first and above 0.5 by the second
  double doubtful = 0; ///< where it is between 0.4 and 0.6 by the first
};

/// What changed between two solids. The first may be open, turned in parts, or cross itself; its
/// winding number decides. At least 8192 points, and up to 2^17 until eight thousand are inside, as
/// far as boundary edges times points stay below 10^8. The same points every time. Parallel.
SolidComparison compareSolids(const TriangleMesh& before, const TriangleMesh& after,
                              Progress& progress);

} // namespace tetvdb
