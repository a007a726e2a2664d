// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/fields/FogVolume.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <gtest/gtest.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <string>

namespace tetvdb {
namespace {

struct Shapes {
  openvdb::BoolGrid::Ptr mask;
  openvdb::FloatGrid::Ptr surface, fog;
};

Shapes shapesOf(const TetMesh& mesh, double halfWidth) {
  VoxelizeOptions options;
  options.voxelSize = {1, 1, 1};
  options.origin = Vec3d{0, 0, 0};
  options.grids = {GridKind::Mask};
  ShapeOptions shapes;
  shapes.grids = {GridKind::Surface, GridKind::Fog};
  shapes.halfWidth = halfWidth;
  Report report;
  Progress progress;
  Voxelization made = voxelize(mesh, options, report, progress);
  addShapeGrids(mesh, shapes, made, report, progress);
  const openvdb::GridPtrVec& all = made.volume.grids().all;
  return {openvdb::gridPtrCast<openvdb::BoolGrid>(all[0]),
          openvdb::gridPtrCast<openvdb::FloatGrid>(all[1]),
          openvdb::gridPtrCast<openvdb::FloatGrid>(all[2])};
}

// OpenVDB's own conversion, voxel by voxel; it divides, and leaves leaves of 0.
TEST(FogVolume, IsThatOfOpenvdb) {
  for (const double halfWidth : {1.5, 3.0, 20.0}) {
    const Shapes made = shapesOf(
        meshes::scaled(meshes::jittered(meshes::kuhnGrid(3, 3, 3), 0.2, 1), 13, {-9.3, 2, 60}),
        halfWidth);
    const openvdb::FloatGrid::Ptr theirs = made.surface->deepCopy();
    openvdb::tools::sdfToFogVolume(*theirs);
    EXPECT_GT(theirs->activeVoxelCount(), 10000u);
    EXPECT_EQ(made.fog->activeVoxelCount(), theirs->activeVoxelCount());
    auto ours = made.fog->getConstAccessor();
    for (auto voxel = theirs->cbeginValueOn(); voxel; ++voxel) {
      const openvdb::Coord at = voxel.getBoundingBox().min();
      ASSERT_NEAR(ours.getValue(at), *voxel, 1e-6F);
      ASSERT_TRUE(ours.isValueOn(at));
    }
  }
}

// A box whose side beyond the last voxel centre lies on centres, at the end of leaves: with a
// half-width of 1 the leaves inside are tiles there, and their nodes have no leaf of fog.
TEST(FogVolume, IsActiveInsideAndNowhereElse) {
  const TetMesh box = meshes::mapped(meshes::kuhnGrid(1, 1, 1), [](const Vec3d& p) {
    return Vec3d{-300 + 364 * p[0], -300 + 600 * p[1], -300 + 600 * p[2]};
  });
  for (const double halfWidth : {1.0, 3.0}) {
    const Shapes made = shapesOf(box, halfWidth);
    EXPECT_EQ(made.mask->activeVoxelCount(), 364u * 600 * 600);
    EXPECT_EQ(made.fog->activeVoxelCount(), made.mask->activeVoxelCount());
    auto fog = made.fog->getConstAccessor();
    EXPECT_EQ(fog.getValue({0, 0, 0}), 1);
    EXPECT_GT(fog.getValue({63, 0, 0}), 0);
    for (const int x : {64, 100, 127})
      EXPECT_FALSE(fog.isValueOn({x, 0, 0}));
  }
}

} // namespace
} // namespace tetvdb
