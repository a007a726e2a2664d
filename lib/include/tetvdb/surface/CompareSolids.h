// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

/// Volumes in world units cubed, estimated by uniform points in the box around both meshes.
struct SolidComparison {
  std::size_t samples = 0, inside = 0; ///< all points; those inside the first or the second mesh
  double before = 0, after = 0;        ///< where the winding number is above 0.5
  double lost = 0;                     ///< above 0.6 in the first mesh, at most 0.5 in the second
  double gained = 0;                   ///< below 0.4 in the first mesh, above 0.5 in the second
  double doubtful = 0;                 ///< from 0.4 to 0.6 in the first mesh
};

/// Compares two solids by winding numbers. The first mesh may be open, inconsistently oriented or
/// self-intersecting. Samples 8192 fixed points, doubled up to 2^17 until 8000 are inside; points
/// times boundary edges are limited to 10^8. Parallel.
SolidComparison compareSolids(const TriangleMesh& before, const TriangleMesh& after,
                              Progress& progress);

} // namespace tetvdb
