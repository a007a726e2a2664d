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
  std::size_t maxMemory = 0; ///< bytes; 0: the available memory
};

/// Returns the surface of the points within `distance` of the solid, or, shrunk, of the points at
/// that distance or farther inside it. `solid` must be closed, oriented and without
/// self-intersections. Between two voxels, of which one is in the result, a vertex lies at the
/// distance within 1e-6 voxel. Edges that the offset keeps sharp, convex ones of a shrunk solid and
/// concave ones of a grown one, are sharp (SharpenCreases.h). Closed, oriented, manifold. Adds
/// stages "voxelize", "distance" and "extract" to `report`. Throws Error(Invalid) if nothing is
/// left, Error(Limit) if memory does not suffice, Error(Usage) for a distance of less than two
/// voxels. Independent of the number of threads.
TriangleMesh offsetSolid(const TriangleMesh& solid, const OffsetOptions& options, Report& report,
                         Progress& progress);

} // namespace tetvdb
