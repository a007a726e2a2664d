// SPDX-License-Identifier: Apache-2.0
//
// Signed distances in a whole box: a level set without a narrow band.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/fields/DistanceBlocks.h"
#include "tetvdb/geometry/NodeBox.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/VoxelBox.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// Voxels of such a box beyond the mesh.
constexpr std::int32_t kBeyondMesh = 3;

/// Of the points of `faces` and the voxels of `inside`, enlarged by kBeyondMesh on every side.
/// `shell`: as for levelSet().
VoxelBox wholeBox(const SnappedMesh& mesh, const Boundary& faces, openvdb::CoordBBox inside,
                  double shell);

/// Expected memory of that grid and of the blocks that make it, of so many faces.
double wholeBoxBytes(const VoxelBox& box, std::size_t faces);

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

/// That level set without a shell, by boxes of nodes.
class WholeBoxParts {
public:
  /// Finds the background. All but `progress` must outlive it, `faces` are not added to. Memory: 48
  /// bytes a face.
  WholeBoxParts(const SnappedMesh& mesh, const Boundary& faces, const GridTransform& transform,
                const VoxelBox& box, Progress& progress);

  /// The nodes of `part`; `inside` must have the voxels of these, others have no effect.
  openvdb::FloatGrid::Ptr grid(const NodeBox& part, const openvdb::BoolGrid& inside,
                               Progress& progress) const;

private:
  DistanceBlocks blocks_;
  const GridTransform& transform_;
  VoxelBox box_;
  float background_ = 0;
};

} // namespace tetvdb
