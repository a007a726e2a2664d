// SPDX-License-Identifier: Apache-2.0
//
// Rasterises every tet: computes the owner of each voxel, and occupancy where tets are about a
// voxel wide.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/voxelize/Slab.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/TetRaster.h"

namespace tetvdb {

/// Bins the tets to slabs, nodes that a tet fills apart, and hands every node that is not empty to
/// `sink`: with owners (the smallest tet index wins) or only bits. Each node is one task; if there
/// are few nodes, each slab is. Returns how many tets were reversed or dropped.
OrientationCounts rasterizeNodes(const SnappedMesh& mesh, bool owners, NodeSink& sink,
                                 Progress& progress);

} // namespace tetvdb
