// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct MeshDistanceOptions {
  std::size_t samples = 100000; ///< points on each mesh, spread by area; vertices come on top
};

/// Distances from points of one mesh to the other mesh, world units. Mean and root mean square are
/// over the mesh's area (over its vertices where it has none), the largest over vertices as well.
struct OneSidedDistance {
  double mean = 0, rms = 0, largest = 0;
  std::size_t points = 0; ///< measured: samples of the area and vertices
  Vec3d where{0, 0, 0};   ///< the point of the first mesh that is farthest from the other
};

struct MeshDistance {
  OneSidedDistance aToB, bToA;
  double hausdorff = 0; ///< larger of the two largest
  double diagonal = 0;  ///< of the box around both
};

/// Samples each mesh's area evenly (a low-discrepancy sequence over the faces' areas: the same
/// points every time, whatever the number of threads) and its vertices, and measures to the other
/// mesh in doubles. The largest distances are lower bounds that the samples reach. Points that no
/// face uses have no part in it. Parallel; about 2 us a sample near the other mesh. Throws
/// Error(Invalid) for a mesh without faces.
MeshDistance compareMeshes(const TriangleMesh& a, const TriangleMesh& b,
                           const MeshDistanceOptions& options, Progress& progress);

} // namespace tetvdb
