// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/volume/Grids.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace tetvdb {
namespace {

TEST(Grids, TransformsMapIndicesExactly) {
  initializeOpenVDB();
  const GridTransform cases[] = {{{0.1, 0.1, 0.1}, {0, 0, 0}},
                                 {{0.1, 0.2, 0.3}, {0, 0, 0}},
                                 {{0.1, 0.1, 0.1}, {5, -3, 1e-4}},
                                 {{0.1, 0.2, 0.3}, {5, -3, 1e-4}}};
  const char* types[] = {"UniformScaleMap", "ScaleMap", "UniformScaleTranslateMap",
                         "ScaleTranslateMap"};
  for (int i = 0; i < 4; ++i) {
    const auto transform = makeTransform(cases[i]);
    EXPECT_EQ(transform->mapType(), types[i]);
    // OpenVDB's own constructor makes 0.1 with origin 5 into 0.09999999999999964.
    EXPECT_EQ(transform->voxelSize(), openvdb::Vec3d(cases[i].voxelSize.data()));
    EXPECT_EQ(transform->indexToWorld(openvdb::Vec3d(0.0)), openvdb::Vec3d(cases[i].origin.data()));
    const openvdb::Vec3d world = transform->indexToWorld(openvdb::Vec3d(7, -11, 1001));
    EXPECT_EQ(world.x(), cases[i].origin[0] + 7 * cases[i].voxelSize[0]);
    EXPECT_EQ(world.y(), cases[i].origin[1] - 11 * cases[i].voxelSize[1]);
    EXPECT_EQ(world.z(), cases[i].origin[2] + 1001 * cases[i].voxelSize[2]);
  }
}

TEST(Grids, ZerosOfBothSignsAreDescribedAsOne) {
  initializeOpenVDB();
  const auto grid = openvdb::FloatGrid::create();
  grid->tree().setValueOn({0, 0, 0}, -0.0F);
  grid->tree().setValueOn({1, 0, 0}, 0.0F);
  grid->tree().setValueOn({9, 0, 0}, -0.0F);
  Volume volume;
  volume.grids().all = {grid};
  const GridInfo info = describe(volume).front();
  EXPECT_FALSE(std::signbit(info.minValue));
  EXPECT_FALSE(std::signbit(info.maxValue));
}

TEST(Grids, TransformsThatCannotBe) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (const GridTransform& bad :
       {GridTransform{{0, 1, 1}, {}}, GridTransform{{1, -1, 1}, {}}, GridTransform{{1, nan, 1}, {}},
        GridTransform{{1, 1, 1}, {nan, 0, 0}}, GridTransform{{1e-5, 1e-5, 1e-5}, {}},
        GridTransform{{1e200, 1e200, 1e200}, {}}})
    EXPECT_THROW(makeTransform(bad), Error);
  EXPECT_NO_THROW(makeTransform({{1.5e-5, 1.5e-5, 1.5e-5}, {}}));
}

TEST(Grids, FirstTileIsOpened) {
  initializeOpenVDB();
  auto grid = openvdb::FloatGrid::create(0.0F);
  openFirstTile(*grid);
  EXPECT_EQ(grid->tree().leafCount(), 0U);
  grid->tree().addTile(1, openvdb::Coord(64, 0, 0), 2.0F, true);
  grid->tree().addTile(3, openvdb::Coord(0, 4096, 0), 3.0F, true);
  grid->tree().addTile(2, openvdb::Coord(0, 4096, 4096), 4.0F, true);
  grid->tree().addTile(3, openvdb::Coord(-4096, 0, 0), 9.0F, false);
  const auto voxels = grid->activeVoxelCount();
  openFirstTile(*grid);
  ASSERT_EQ(grid->tree().leafCount(), 1U);
  EXPECT_EQ(grid->tree().cbeginLeaf()->origin(), openvdb::Coord(0, 4096, 0));
  EXPECT_EQ(grid->activeVoxelCount(), voxels);
  EXPECT_EQ(grid->tree().getValue(openvdb::Coord(3, 4099, 3)), 3.0F);
  openFirstTile(*grid);
  EXPECT_EQ(grid->tree().leafCount(), 1U);

  auto mask = openvdb::BoolGrid::create(false);
  mask->tree().addTile(1, openvdb::Coord(8, 8, 8), true, true);
  openFirstTile(*mask);
  EXPECT_EQ(mask->tree().leafCount(), 1U);
  EXPECT_EQ(mask->activeVoxelCount(), 512U);
}

} // namespace
} // namespace tetvdb
