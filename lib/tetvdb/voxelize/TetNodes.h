// SPDX-License-Identifier: Apache-2.0
//
// Every tet rasterised: who owns each voxel, and occupancy where tets are about a voxel wide.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/voxelize/Slab.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/TetRaster.h"

namespace tetvdb {

/// Bins the tets to slabs, nodes that a tet fills apart, and hands every node that is not empty to
/// `sink`: with owners (lowest tet index wins) or bits alone. One task a node, its slabs apart
/// where nodes are few. Returns how many tets were reversed or dropped.
OrientationCounts rasterizeNodes(const SnappedMesh& mesh, bool owners, NodeSink& sink,
                                 Progress& progress);

} // namespace tetvdb
