// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Report.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace tetvdb {

/// A box in world space; empty until something is added.
struct WorldBox {
  Vec3d min{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
            std::numeric_limits<double>::infinity()};
  Vec3d max{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
            -std::numeric_limits<double>::infinity()};
  bool finite = true; ///< false: one of the points was not

  void add(const WorldBox& other);
  /// Moves every side outward.
  void grow(double length);
};

/// Boxes of points: of all, and of those in use.
struct PointBoxes {
  WorldBox all, used;
};
PointBoxes boxesOf(const std::vector<Vec3d>& points, const std::vector<std::uint32_t>& indices);

/// Box of those of `points` that `indices` (of cells or faces) name. Parallel; where every side of
/// the box is touched by some point in use, which is nearly always so, it looks at few indices.
WorldBox boxOfUsed(const std::vector<Vec3d>& points, const std::vector<std::uint32_t>& indices);

/// Which voxel centres on the ends of a box, along each axis, count as in it.
enum class BoxEnds : std::uint8_t {
  OneIn, ///< those at one end, as by the ownership rule (geometry/Ownership.h)
  BothIn ///< those at both, as of a shell
};

/// Voxel size and origin for a mesh in that box. options.voxelSize; or the smallest size by which
/// no side of the box, snapped to the lattice, has more than options.resolution voxels, but not
/// below OpenVDB's least, 1.45e-5; or that by which the box fits options.fit. The origin is
/// options.origin, moved by a multiple of 4096 voxels where the box leaves 32-bit index space, or
/// what options.fit asks for. Throws as voxelize() does.
GridTransform chooseTransform(const WorldBox& box, const VoxelizeOptions& options,
                              BoxEnds ends = BoxEnds::OneIn);

/// Whether no side of the box, snapped to the lattice, can have more than that many voxel centres.
bool isWithinResolution(const WorldBox& box, const GridTransform& transform, int voxels,
                        BoxEnds ends = BoxEnds::OneIn);

/// Whether the box, snapped to the lattice, lies within the cubes of the voxels fit.padding to
/// fit.voxels - 1 - fit.padding.
bool isWithinFit(const WorldBox& box, const GridTransform& transform, const FitBox& fit);

/// Throws as voxelize() does for tets that cannot be voxelized by these options.
void checkTets(const TetMesh& mesh, const VoxelizeOptions& options);

/// Warns where `transform` has another origin than was asked for ("origin-moved"), or where the
/// mesh is too small for options.resolution ("smallest-voxels").
void reportTransform(const GridTransform& transform, const VoxelizeOptions& options,
                     Report& report);

/// Warns of tets that were reversed ("flipped-tets") or left out ("flat-tets").
void reportTets(const SnapCounts& counts, std::size_t tets, Report& report);

/// Throws Error(Invalid) where no voxel is active and options.allowEmpty is not set.
void requireVoxels(const Voxelization& result, const VoxelizeOptions& options);
/// The same, where it is known whether one is.
void requireVoxels(bool empty, const VoxelizeOptions& options);

} // namespace tetvdb
