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
};

/// Box of those of `points` that `indices` (of cells or faces) name. Parallel; where every side of
/// the box is touched by some point in use, which is nearly always so, it looks at few indices.
WorldBox boxOfUsed(const std::vector<Vec3d>& points, const std::vector<std::uint32_t>& indices);

/// Voxel size and origin for a mesh in that box: options.voxelSize, or by options.resolution along
/// the longest side; the origin moved by a multiple of 4096 voxels where the box leaves 32-bit
/// index space. Throws as voxelize() does.
GridTransform chooseTransform(const WorldBox& box, const VoxelizeOptions& options);

/// Warns ("origin-moved") where `transform` has another origin than was asked for.
void reportOrigin(const GridTransform& transform, const VoxelizeOptions& options, Report& report);

/// Warns of tets that were turned round ("flipped-tets") or left out ("flat-tets").
void reportTets(const SnapCounts& counts, std::size_t tets, Report& report);

/// Throws Error(Invalid) where no voxel is active and options.allowEmpty is not set.
void requireVoxels(const Voxelization& result, const VoxelizeOptions& options);

} // namespace tetvdb
