// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/Volume.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <openvdb/tools/Prune.h>
#include <random>
#include <tbb/global_control.h>
#include <utility>

namespace tetvdb {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;

Volume volumeOf(const openvdb::GridBase::Ptr& grid) {
  Volume volume;
  volume.grids().all = {grid};
  return volume;
}

FloatGrid::Ptr newGrid(const char* name = "density") {
  initializeOpenVDB();
  auto grid = FloatGrid::create(0.0F);
  grid->setName(name);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  return grid;
}

std::vector<std::pair<Coord, float>> someVoxels() {
  std::mt19937 random(3);
  std::vector<std::pair<Coord, float>> voxels;
  for (int i = 0; i < 5000; ++i) {
    const auto coordinate = [&] { return static_cast<int>(random() % 9000) - 4500; };
    const int x = coordinate(), y = coordinate(), z = coordinate();
    voxels.push_back({Coord(x, y, z), static_cast<float>(i)});
  }
  return voxels;
}

FloatGrid::Ptr gridOf(const std::vector<std::pair<Coord, float>>& voxels) {
  auto grid = newGrid();
  for (const auto& [at, value] : voxels)
    grid->tree().setValueOn(at, value);
  return grid;
}

TEST(Hash, IndependentOfOrderThreadsMetadataAndEmptyNodes) {
  auto voxels = someVoxels();
  const std::string expected = hash(volumeOf(gridOf(voxels)));
  EXPECT_EQ(expected.size(), 32U);
  std::reverse(voxels.begin(), voxels.end());
  auto grid = gridOf(voxels);
  EXPECT_EQ(hash(volumeOf(grid)), expected);
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(hash(volumeOf(grid)), expected);
  }
  grid->setCreator("someone");
  Volume volume = volumeOf(grid);
  volume.metadata["source"] = "a.vtu";
  EXPECT_EQ(hash(volume), expected);
  // Nodes that hold nothing but inactive background.
  grid->tree().addTile(1, Coord(20000, 0, 0), 0.0F, false);
  grid->tree().addTile(3, Coord(30000, 0, 0), 0.0F, false);
  EXPECT_EQ(hash(volumeOf(grid)), expected);
}

TEST(Hash, KnowsEveryChange) {
  const auto build = [] { return gridOf(someVoxels()); };
  const std::string expected = hash(volumeOf(build()));
  const auto changed = [&](auto change) {
    auto grid = build();
    change(*grid);
    return hash(volumeOf(grid)) != expected;
  };
  const Coord voxel = someVoxels().front().first, free(100000, 3, 3);
  EXPECT_FALSE(changed([](FloatGrid&) {}));
  EXPECT_TRUE(changed([&](FloatGrid& g) { g.tree().setValueOn(voxel, -1.0F); }));
  EXPECT_TRUE(changed([&](FloatGrid& g) { g.tree().setActiveState(voxel, false); }));
  EXPECT_TRUE(changed([&](FloatGrid& g) { g.tree().setValueOff(voxel.offsetBy(1), 1.0F); }));
  EXPECT_TRUE(changed([&](FloatGrid& g) { g.tree().setValueOn(voxel.offsetBy(1), 0.0F); }));
  EXPECT_TRUE(changed([&](FloatGrid& g) { g.tree().touchLeaf(free); }));
  EXPECT_TRUE(changed([&](FloatGrid& g) { g.tree().addTile(1, free, 1.0F, true); }));
  EXPECT_TRUE(changed([&](FloatGrid& g) { g.tree().addTile(1, free, 1.0F, false); }));
  EXPECT_TRUE(changed([&](FloatGrid& g) { g.tree().addTile(2, free, 1.0F, true); }));
  EXPECT_TRUE(changed([&](FloatGrid& g) { g.tree().addTile(3, free, 1.0F, true); }));
  EXPECT_TRUE(changed([&](FloatGrid& g) { g.setName("other"); }));
  EXPECT_TRUE(changed([&](FloatGrid& g) { g.setGridClass(openvdb::GRID_LEVEL_SET); }));
  EXPECT_TRUE(changed([&](FloatGrid& g) { g.setTransform(makeTransform({{1, 1, 2}, {}})); }));
  EXPECT_TRUE(changed([&](FloatGrid& g) {
    g.setTransform(makeTransform({{1, 1, 1}, {0, 1, 0}}));
  }));
  // The same map of another class is the same transform.
  EXPECT_FALSE(changed([&](FloatGrid& g) {
    g.setTransform(openvdb::math::Transform::Ptr(new openvdb::math::Transform(
        openvdb::math::MapBase::Ptr(new openvdb::math::ScaleMap(openvdb::Vec3d(1))))));
  }));
}

TEST(Hash, TileAndDenseLeafDiffer) {
  auto tile = newGrid(), leaf = newGrid();
  tile->tree().addTile(1, Coord(8, 8, 8), 1.0F, true);
  leaf->fill({Coord(8), Coord(15)}, 1.0F);
  leaf->tree().voxelizeActiveTiles();
  ASSERT_EQ(leaf->tree().leafCount(), 1U);
  EXPECT_NE(hash(volumeOf(tile)), hash(volumeOf(leaf)));
  openvdb::tools::prune(leaf->tree());
  EXPECT_EQ(hash(volumeOf(tile)), hash(volumeOf(leaf)));
}

TEST(Hash, ValuesCountByTheirBits) {
  auto zero = newGrid(), minus = newGrid();
  zero->tree().setValueOn({1, 2, 3}, 0.0F);
  minus->tree().setValueOn({1, 2, 3}, -0.0F);
  EXPECT_NE(hash(volumeOf(zero)), hash(volumeOf(minus)));
  auto nan = newGrid(), same = newGrid();
  nan->tree().setValueOn({1, 2, 3}, std::numeric_limits<float>::quiet_NaN());
  same->tree().setValueOn({1, 2, 3}, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(hash(volumeOf(nan)), hash(volumeOf(same)));
}

TEST(Hash, OrderOfGridsDoesNotMatter) {
  auto a = newGrid("a"), b = newGrid("b");
  b->tree().setValueOn({1, 2, 3}, 4.0F);
  Volume one, two;
  one.grids().all = {a, b};
  two.grids().all = {b, a};
  EXPECT_EQ(hash(one), hash(two));
  EXPECT_NE(hash(one), hash(volumeOf(a)));
}

TEST(Describe, CountsTilesVoxelsAndRanges) {
  auto grid = newGrid();
  grid->setTransform(makeTransform({{0.5, 1, 2}, {1, 2, 3}}));
  grid->tree().setValueOn({-5, 7, 9}, -2.5F);
  grid->tree().setValueOff({-9, -9, -9}, 99.0F);
  grid->tree().addTile(1, Coord(128, 0, 0), 4.0F, true);
  grid->tree().addTile(2, Coord(4096, 0, 0), 1.0F, true);
  grid->tree().addTile(3, Coord(0, 8192, 0), 0.5F, true);
  grid->tree().addTile(3, Coord(0, 12288, 0), 500.0F, false);
  const GridInfo info = describe(volumeOf(grid)).at(0);
  EXPECT_EQ(info.name, "density");
  EXPECT_EQ(info.type, "float");
  EXPECT_EQ(info.gridClass, "fog volume");
  EXPECT_EQ(info.activeVoxels, grid->activeVoxelCount());
  EXPECT_EQ(info.activeTiles, 3U);
  EXPECT_EQ(info.leaves, 2U);
  EXPECT_DOUBLE_EQ(info.volume, double(info.activeVoxels));
  EXPECT_EQ(info.minValue, -2.5);
  EXPECT_EQ(info.maxValue, 4.0);
  const auto box = grid->evalActiveVoxelBoundingBox();
  EXPECT_EQ(Coord(info.boxMin.data()), box.min());
  EXPECT_EQ(Coord(info.boxMax.data()), box.max());
  EXPECT_EQ(info.transform.voxelSize, (Vec3d{0.5, 1, 2}));
  EXPECT_EQ(info.transform.origin, (Vec3d{1, 2, 3}));
  EXPECT_TRUE(info.linear);
  EXPECT_EQ(info.metadata.at("class"), "fog volume");
  EXPECT_NEAR(double(info.bytes), double(grid->memUsage()), 0.01 * double(grid->memUsage()));
}

TEST(Describe, EmptyBoolAndVectorGrids) {
  const GridInfo empty = describe(volumeOf(newGrid())).at(0);
  EXPECT_EQ(empty.activeVoxels, 0U);
  EXPECT_GT(empty.boxMin[0], empty.boxMax[0]);

  auto mask = openvdb::BoolGrid::create(false);
  mask->tree().setValueOn({1, 2, 3}, true);
  mask->tree().setValueOn({1, 2, 4}, false);
  const GridInfo info = describe(volumeOf(mask)).at(0);
  EXPECT_EQ(info.type, "bool");
  EXPECT_EQ(info.minValue, 0.0);
  EXPECT_EQ(info.maxValue, 1.0);

  auto vectors = openvdb::Vec3SGrid::create();
  vectors->tree().setValueOn({1, 2, 3}, openvdb::Vec3s(3, 4, 0));
  EXPECT_EQ(describe(volumeOf(vectors)).at(0).maxValue, 5.0);

  auto turned = newGrid();
  turned->transform().postRotate(0.3, openvdb::math::Z_AXIS);
  EXPECT_FALSE(describe(volumeOf(turned)).at(0).linear);
}

/// Counts voxel by voxel within a box that holds both grids.
GridComparison bruteForce(const FloatGrid& a, const FloatGrid& b, const openvdb::CoordBBox& box) {
  GridComparison result;
  for (auto at = box.begin(); at; ++at) {
    float va = 0, vb = 0;
    const bool inA = a.tree().probeValue(*at, va), inB = b.tree().probeValue(*at, vb);
    result.activeA += inA;
    result.activeB += inB;
    result.activeBoth += inA && inB;
    result.stateDiffers += inA != inB;
    result.valueDiffers += inA && inB && va != vb;
    if (inA || inB)
      result.largestDifference =
          std::max(result.largestDifference,
                   std::abs(double(inA ? va : a.background()) - double(inB ? vb : b.background())));
  }
  return result;
}

TEST(Compare, AgreesWithBruteForceAlsoAcrossTiles) {
  std::mt19937 random(11);
  for (int round = 0; round < 6; ++round) {
    FloatGrid::Ptr grids[2] = {newGrid(), newGrid()};
    for (auto& grid : grids) {
      for (int i = 0; i < 6; ++i) {
        const Coord from(int(random() % 120) - 60, int(random() % 120) - 60,
                         int(random() % 120) - 60);
        const Coord size(int(random() % 60), int(random() % 60), int(random() % 60));
        grid->sparseFill({from, from + size}, float(random() % 3), random() % 4 != 0);
      }
      if (random() % 2 == 0)
        grid->tree().addTile(1, Coord(16, 16, 16), 2.0F, true);
    }
    const openvdb::CoordBBox box(Coord(-70), Coord(130));
    const GridComparison expected = bruteForce(*grids[0], *grids[1], box);
    const auto result = compareVolumes(volumeOf(grids[0]), volumeOf(grids[1]));
    ASSERT_EQ(result.grids.size(), 1U);
    const GridComparison& found = result.grids[0];
    EXPECT_EQ(found.activeA, expected.activeA);
    EXPECT_EQ(found.activeB, expected.activeB);
    EXPECT_EQ(found.activeBoth, expected.activeBoth);
    EXPECT_EQ(found.stateDiffers, expected.stateDiffers);
    EXPECT_EQ(found.valueDiffers, expected.valueDiffers);
    EXPECT_EQ(found.largestDifference, expected.largestDifference);
    EXPECT_FALSE(result.same());
  }
}

TEST(Compare, TileAgainstOpenedTileIsTheSameVoxels) {
  auto tiles = newGrid(), leaves = newGrid();
  for (auto& grid : {tiles, leaves}) {
    grid->tree().addTile(3, Coord(4096, 0, 0), 1.0F, true);
    grid->tree().addTile(2, Coord(0, 0, 0), 1.0F, true);
  }
  leaves->tree().touchLeaf(Coord(5000, 3, 3));
  leaves->tree().touchLeaf(Coord(5, 3, 3));
  const auto result = compareVolumes(volumeOf(tiles), volumeOf(leaves));
  EXPECT_TRUE(result.same());
  EXPECT_FALSE(result.sameHash);
  EXPECT_EQ(result.grids.at(0).activeBoth, tiles->activeVoxelCount());
  EXPECT_EQ(result.grids.at(0).iou(), 1.0);
}

TEST(Compare, NamesTypesTransformsAndNaN) {
  Volume a, b;
  auto number = newGrid("same"), other = newGrid("same");
  number->tree().setValueOn({1, 1, 1}, 1.0F);
  other->tree().setValueOn({1, 1, 1}, std::numeric_limits<float>::quiet_NaN());
  auto typed = openvdb::Int32Grid::create();
  typed->setName("typed");
  a.grids().all = {number, newGrid("left"), newGrid("typed")};
  b.grids().all = {typed, newGrid("right"), other};
  auto result = compareVolumes(a, b);
  EXPECT_EQ(result.onlyA, std::vector<std::string>{"left"});
  EXPECT_EQ(result.onlyB, std::vector<std::string>{"right"});
  EXPECT_EQ(result.incomparable, std::vector<std::string>{"typed"});
  EXPECT_EQ(result.grids.at(0).valueDiffers, 1U);
  EXPECT_TRUE(std::isinf(result.grids.at(0).largestDifference));
  EXPECT_TRUE(result.sameTransform);
  other->setTransform(makeTransform({{2, 2, 2}, {}}));
  EXPECT_FALSE(compareVolumes(a, b).sameTransform);

  // NaN of the same bits, and zeros of either sign, are no difference.
  EXPECT_TRUE(compareVolumes(volumeOf(other), volumeOf(other)).same());
  auto zero = newGrid(), minus = newGrid();
  zero->tree().setValueOn({1, 2, 3}, 0.0F);
  minus->tree().setValueOn({1, 2, 3}, -0.0F);
  EXPECT_TRUE(compareVolumes(volumeOf(zero), volumeOf(minus)).same());
  EXPECT_FALSE(compareVolumes(volumeOf(zero), volumeOf(minus)).sameHash);
}

} // namespace
} // namespace tetvdb
