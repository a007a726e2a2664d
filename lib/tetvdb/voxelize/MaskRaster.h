// SPDX-License-Identifier: Apache-2.0
//
// Passes the voxels of existing masks to a sink, as a rasteriser does.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/Slab.h"

#include <vector>

namespace tetvdb {

/// Hands to `sink` the voxels that are active in any of the masks, with owners: the number, from 0,
/// of the first mask that a voxel is active in. Parallel by 128^3 nodes.
void rasterizeMasks(const std::vector<openvdb::BoolGrid::ConstPtr>& masks, NodeSink& sink,
                    Progress& progress);

} // namespace tetvdb
