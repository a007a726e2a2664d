// SPDX-License-Identifier: Apache-2.0
//
// Occupancy from the boundary alone: along each z column the signed crossings of the boundary faces
// are summed, and a voxel is inside where the sum is positive. Interior faces cancel exactly under
// the ownership rule, so this is the union of the tets, voxel by voxel.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/Slab.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstdint>

namespace tetvdb {

/// Upper estimate of the leaf nodes that the boundary passes through.
std::uint64_t estimateBoundaryLeaves(const SnappedMesh& mesh, const Boundary& boundary);

/// Hands every node that is not empty to `sink`: those that the boundary meets slab by slab, full
/// ones between them as runs. A stack of nodes along z is one task, since the sums are carried from
/// node to node; nodes that no face meets cost nothing. Time follows the number of columns that
/// faces cross and of nodes that they meet.
void rasterizeBoundary(const SnappedMesh& mesh, const Boundary& boundary, NodeSink& sink,
                       Progress& progress);

} // namespace tetvdb
