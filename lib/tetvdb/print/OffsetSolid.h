// SPDX-License-Identifier: Apache-2.0
//
// A solid grown or shrunk by a distance.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct OffsetOptions {
  double distance = 0;       ///< world units: above 0 grown, below 0 shrunk; two voxels or more
  double voxel = 0;          ///< world units
  std::size_t maxMemory = 0; ///< bytes; 0: what the machine has available
};

/// The surface of all that is within `distance` of the solid, or, shrunk, that is that far or
/// farther within it. `solid` is closed, oriented and without self-intersections. Between
/// two voxels, of which one is in the result, a vertex lies where the distance passes, within 1e-6
/// voxel. Edges that stay sharp, convex ones of a shrunk solid and concave ones of a grown one,
/// come out sharp (SharpenCreases.h). Closed, oriented, manifold. Adds stages "voxelize",
/// "distance" and "extract" to `report`. Throws Error(Invalid) where nothing is left, Error(Limit)
/// where memory does not do, Error(Usage) for a distance of less than two voxels. The same for any
/// number of threads.
TriangleMesh offsetSolid(const TriangleMesh& solid, const OffsetOptions& options, Report& report,
                         Progress& progress);

} // namespace tetvdb
