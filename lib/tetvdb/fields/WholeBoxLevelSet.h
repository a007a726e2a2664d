// SPDX-License-Identifier: Apache-2.0
//
// Signed distances in a whole box: a level set without a narrow band.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/VoxelBox.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SnappedMesh.h"

namespace tetvdb {

/// Returns a float level set "surface" in which exactly the voxels of `box` are active. The sign is
/// exactly that of `inside` (active: inside). The absolute value is the distance to the nearest of
/// `faces` in world units, within kDistanceError voxels and the rounding of single precision.
/// Voxels outside of the box have the background, the largest absolute value inside it. `inside`
/// must have `transform`, whose voxels must be cubes, and `faces`, at least one, must be snapped by
/// it. The result depends on the faces as a set and on `inside` only. `shell`: as for levelSet().
/// Parallel; cost and method: fields/DistanceBlocks.h. Memory: the grid, about 4.3 bytes per voxel,
/// and 48 bytes per face.
openvdb::FloatGrid::Ptr wholeBoxLevelSet(const SnappedMesh& mesh, const Boundary& faces,
                                         const openvdb::BoolGrid& inside,
                                         const GridTransform& transform, const VoxelBox& box,
                                         double shell, Progress& progress);

} // namespace tetvdb
