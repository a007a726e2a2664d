// SPDX-License-Identifier: Apache-2.0
//
// Grids of a solid's shape beyond which voxels are inside: its level set, the fog made of that, and
// how much of every voxel it fills.
//
//   options.grids = {tetvdb::GridKind::Mask};
//   tetvdb::Voxelization made = tetvdb::voxelize(mesh, options, report, progress);
//   tetvdb::ShapeOptions shapes;
//   shapes.grids = {tetvdb::GridKind::Surface};
//   tetvdb::addShapeGrids(mesh, shapes, made, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/fields/CoverageSum.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/volume/GridKinds.h"
#include "tetvdb/volume/VoxelBox.h"
#include "tetvdb/voxelize/DeviceChoice.h"
#include "tetvdb/voxelize/TrimCounts.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace tetvdb {

/// A half-width that has every voxel of a box in the band (fields/WholeBoxLevelSet.h).
constexpr double kWholeBox = std::numeric_limits<double>::infinity();

struct ShapeOptions {
  std::vector<GridKind> grids; ///< made by GridMaker::Distance or Share
  double halfWidth = 3;        ///< of the level set's band, voxels, or kWholeBox
  /// With kWholeBox, the box; none: the mesh's, grown by three voxels.
  std::optional<VoxelBox> box;
  /// Where the level set's distances are found; the grids are the same.
  DeviceChoice device = {DeviceKind::Cpu, {0}};
  std::size_t maxMemory = 0; ///< bytes for this stage; 0: what the machine has available
};

/// What else addShapeGrids() found.
struct ShapeSums {
  CoverageSum coverage; ///< where GridKind::Coverage was asked for
  TrimCounts trim;      ///< where a level set or fog was
  DeviceUsed device;    ///< what found the distances
};

/// Throws Error(Usage) for a half-width out of range, a grid asked for twice, or a level set of
/// voxels that are not cubes.
void checkShapes(const ShapeOptions& options, const Vec3d& voxelSize);

/// Adds options.grids, in that order, to the end of made.volume, which must hold the grid "mask"
/// that voxelize() made of the same mesh. Signs are the mask's, distances those to the boundary of
/// the tets' union (voxelize/TrimFaces.h; where that is given up, to all boundary faces, with the
/// warning "untrimmed"). Adds stage "fields" to `report`, and the warning "overlap" where tets that
/// overlap fill voxels more than once. Where options.device is Auto the GPU finds the distances if
/// it is expected to be faster, and the CPU takes over where it fails or has too little memory,
/// with the warning "device-left". Throws as checkShapes() does, Error(Limit) where memory does not
/// suffice, Error(Device) where a GPU is asked for that is not there or fails, Error(Cancelled).
ShapeSums addShapeGrids(const TetMesh& mesh, const ShapeOptions& options, Voxelization& made,
                        Report& report, Progress& progress);

/// The same for triangles made a solid by `solid`. Where faces close, distances
/// are to the boundary of what `solid` takes for inside. Of open meshes, and by InsideRule::Flood,
/// they are to all faces (a warning says where these cross), and where holes are closed to the
/// surface at which the winding number passes a half, found to about a voxel. With
/// solid.shell, distances are to the faces less half of it; by its side those of shellSurface(), of
/// closed meshes alone (else Error(Invalid)). Coverage needs faces that close and
/// InsideRule::Winding: else Error(Invalid) or Error(Usage).
ShapeSums addShapeGrids(const TriangleMesh& mesh, const SolidOptions& solid,
                        const ShapeOptions& options, Voxelization& made, Report& report,
                        Progress& progress);

} // namespace tetvdb
