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

/// A float level set "surface" in which all voxels of `box` are active, and no others. The sign is
/// `inside`'s (active: inside), exactly; the absolute value is the distance to the nearest of
/// `faces` in world units, within kDistanceError voxels and the rounding of single precision.
/// Voxels outside of the box have the background, the largest absolute value within. `inside` must
/// have `transform`, whose voxels must be cubes, and `faces`, of which there is one at least, be
/// snapped by it. The result depends on the faces as a set and on `inside` alone. `shell`: as for
/// levelSet(). Parallel; cost and method: fields/DistanceBlocks.h. Memory: the grid, about 4.3
/// bytes a voxel, and 48 bytes a face.
openvdb::FloatGrid::Ptr wholeBoxLevelSet(const SnappedMesh& mesh, const Boundary& faces,
                                         const openvdb::BoolGrid& inside,
                                         const GridTransform& transform, const VoxelBox& box,
                                         double shell, Progress& progress);

} // namespace tetvdb
