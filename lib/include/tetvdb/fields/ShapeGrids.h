// SPDX-License-Identifier: Apache-2.0
//
// Grids of a solid's shape in addition to its inside: the level set, the fog made from it, and the
// filled share of every voxel.
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

/// A half-width for which every voxel of a box is in the band (fields/WholeBoxLevelSet.h).
constexpr double kWholeBox = std::numeric_limits<double>::infinity();

struct ShapeOptions {
  std::vector<GridKind> grids; ///< made by GridMaker::Distance or Share
  double halfWidth = 3;        ///< of the level set's band, voxels, or kWholeBox
  /// With kWholeBox: the box; none: that of the mesh, enlarged by three voxels.
  std::optional<VoxelBox> box;
  /// The device that computes the level set's distances; the grids are the same.
  DeviceChoice device = {DeviceKind::Cpu, {0}};
  std::size_t maxMemory = 0; ///< bytes for this stage; 0: the available memory
};

/// Further results of addShapeGrids().
struct ShapeSums {
  CoverageSum coverage;      ///< if GridKind::Coverage was requested
  TrimCounts trim;           ///< if a level set or fog was requested
  DeviceUsed device;         ///< the device that computed the distances
  DeviceUsed coverageDevice; ///< the device that computed the coverage
};

/// Throws Error(Usage) for a half-width out of range, a repeated grid, or a level set of voxels
/// that are not cubes.
void checkShapes(const ShapeOptions& options, const Vec3d& voxelSize);

/// Appends options.grids, in that order, to made.volume, which must contain the grid "mask" that
/// voxelize() made of the same mesh. Signs are those of the mask, distances those to the boundary
/// of the tets' union (voxelize/TrimFaces.h; if that fails, to all boundary faces, with the warning
/// "untrimmed"). Adds stage "fields" to `report`, and the warning "overlap" if overlapping tets
/// fill voxels more than once. If options.device is Auto, the GPU computes the distances if it is
/// expected to be faster, and the CPU is used if it fails or has too little memory, with the
/// warning "device-left". Throws as checkShapes() does, Error(Limit) if memory does not suffice,
/// Error(Device) if a requested GPU does not exist or fails, Error(Cancelled).
ShapeSums addShapeGrids(const TetMesh& mesh, const ShapeOptions& options, Voxelization& made,
                        Report& report, Progress& progress);

/// The same for triangles that `solid` defines as a solid. For closed faces, distances are to the
/// boundary of the inside by `solid`. For open meshes, and with InsideRule::Flood, they are to all
/// faces (a warning is given if these cross), and where holes are closed, to the surface at which
/// the winding number equals 0.5, located to about a voxel. With solid.shell, distances are to the
/// faces minus half of it; with its side those of shellSurface(), for closed meshes only (else
/// Error(Invalid)). Coverage requires closed faces and InsideRule::Winding: else Error(Invalid) or
/// Error(Usage).
ShapeSums addShapeGrids(const TriangleMesh& mesh, const SolidOptions& solid,
                        const ShapeOptions& options, Voxelization& made, Report& report,
                        Progress& progress);

} // namespace tetvdb
