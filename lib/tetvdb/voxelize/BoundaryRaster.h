// SPDX-License-Identifier: Apache-2.0
//
// Occupancy from faces alone: along each z column the signed crossings of the faces are summed, and
// the sum decides which voxels are inside. Interior faces of tets cancel exactly under the
// ownership rule, so with the boundary of tets this is their union, voxel by voxel; with a closed
// triangle soup the sum is its winding number; with an open one the solid angles of the triangles
// over its holes are added (WindingBand.h).
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/TriangleClusters.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/FillRule.h"
#include "tetvdb/voxelize/Slab.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstdint>

namespace tetvdb {

/// Upper estimate of the leaf nodes that the boundary passes through.
std::uint64_t estimateBoundaryLeaves(const SnappedMesh& mesh, const Boundary& boundary);

struct FillOptions {
  FillRule rule = FillRule::Positive;
  /// The triangles that fill the holes of an open soup (fillHoles()); null where the faces close.
  /// With FillRule::Odd they have no meaning: then every edge must have an even number of faces.
  const TriangleClusters* holes = nullptr;
};

/// Hands every node that is not empty to `sink`: those that faces meet slab by slab, full ones
/// between them as runs. A stack of nodes along z is one task, since the sums are carried from node
/// to node; nodes that no face meets cost nothing. Time follows the number of columns that faces
/// cross and of nodes that they meet, and for open soups the area over which the winding number
/// passes a half off the faces.
void rasterizeBoundary(const SnappedMesh& mesh, const Boundary& boundary, const FillOptions& fill,
                       NodeSink& sink, Progress& progress);

} // namespace tetvdb
