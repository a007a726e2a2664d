// SPDX-License-Identifier: Apache-2.0
#include "FileBytes.h"
#include "TemporaryFolder.h"
#include "io/VolumeSamples.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/VolumeStream.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

template <class GridT>
typename GridT::Ptr gridWith(const char* name, typename GridT::ValueType background) {
  auto grid = GridT::create(background);
  grid->setName(name);
  grid->setTransform(makeTransform({{0.1, 0.1, 0.1}, {-3, 7.5, 1e-3}}));
  return grid;
}

// Of several types, each with entries of the root node on both sides of zero.
Volume gridsOfAllTypes() {
  initializeOpenVDB();
  Volume volume;
  volume.metadata["source"] = "a test";
  auto fog = gridWith<openvdb::FloatGrid>("density", 0.0F);
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  fog->sparseFill({openvdb::Coord(-300, -9, -70), openvdb::Coord(171, 140, 133)}, 1.0F, true);
  for (int i = 0; i < 3000; ++i)
    fog->tree().setValueOn(openvdb::Coord(i * 5, (i * 7) % 501, -i * 3), float(i % 3));
  fog->tree().addTile(3, openvdb::Coord(8192, 0, 0), 1.0F, true);
  fog->tree().addTile(3, openvdb::Coord(-8192, 0, 0), 2.5F, false);
  fog->tree().addTile(2, openvdb::Coord(256, 1024, 0), 1.0F, true);
  fog->setSaveFloatAsHalf(true);
  auto mask = gridWith<openvdb::BoolGrid>("mask", false);
  mask->sparseFill({openvdb::Coord(-20), openvdb::Coord(99)}, true, true);
  auto set = gridWith<openvdb::MaskGrid>("set", false);
  set->sparseFill({openvdb::Coord(-20), openvdb::Coord(5000, 9, 9)}, true, true);
  auto id = gridWith<openvdb::Int32Grid>("tet_id", -1);
  for (int i = 0; i < 4000; ++i)
    id->tree().setValueOn({i % 9000 - 4500, i % 77, i % 13}, i);
  auto velocity = gridWith<openvdb::Vec3SGrid>("vel", openvdb::Vec3s(0));
  velocity->sparseFill({openvdb::Coord(-5), openvdb::Coord(30)}, openvdb::Vec3s(1, 2, 3), true);
  auto sphere =
      openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(9, openvdb::Vec3f(0), 0.1F);
  sphere->setName("surface");
  sphere->setTransform(fog->transformPtr());
  auto nothing = gridWith<openvdb::DoubleGrid>("nothing", 0.25);
  volume.grids().all = {fog, mask, set, id, velocity, sphere, nothing};
  return volume;
}

TEST(VolumeStream, DescribesAndHashesAsAWhole) {
  const TemporaryFolder folder;
  Progress progress;
  writeVolume(folder / "a.vdb", gridsOfAllTypes(), progress);
  const Volume whole = readVolume(folder / "a.vdb", progress);
  ASSERT_TRUE(canStreamVolume(folder / "a.vdb"));
  const StreamedInfo streamed = describeVolumeFile(folder / "a.vdb", true, progress);
  EXPECT_EQ(streamed.hash, hash(whole));
  EXPECT_EQ(streamed.metadata, whole.metadata);
  const std::vector<GridInfo> expected = describe(whole);
  ASSERT_EQ(streamed.grids.size(), expected.size());
  for (const GridInfo& b : expected) {
    const auto found = std::find_if(streamed.grids.begin(), streamed.grids.end(),
                                    [&](const GridInfo& grid) { return grid.name == b.name; });
    ASSERT_NE(found, streamed.grids.end());
    const GridInfo& a = *found;
    test::expectSameCounts(a, b);
    EXPECT_EQ(a.gridClass, b.gridClass);
    EXPECT_EQ(a.volume, b.volume) << b.name;
    EXPECT_EQ(a.metadata, b.metadata) << b.name;
    EXPECT_EQ(a.transform.voxelSize, b.transform.voxelSize);
    EXPECT_EQ(a.transform.origin, b.transform.origin);
  }
}

// More nodes in a child of the root than are read at a time, with tiles among them.
TEST(VolumeStream, DescribesAndHashesChildrenInParts) {
  initializeOpenVDB();
  const TemporaryFolder folder;
  Progress progress;
  Volume volume;
  auto sphere =
      openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(150, openvdb::Vec3f(60), 1.0F);
  sphere->setName("surface");
  auto coverage = sphere->deepCopy();
  openvdb::tools::sdfToFogVolume(*coverage);
  coverage->setName("coverage");
  auto id = gridWith<openvdb::Int32Grid>("tet_id", -1);
  id->setTransform(sphere->transformPtr());
  for (const auto& low : {openvdb::Coord(-300, -200, -100), openvdb::Coord(3000, 700, 10)})
    for (int i = 0; i < 5000; ++i)
      id->tree().setValueOn(low.offsetBy(8 * (i % 17), 8 * (i / 17 % 17), 8 * (i / 289)), i);
  id->tree().addTile(2, openvdb::Coord(2048, 2048, 2048), 7, true);
  id->tree().addTile(2, openvdb::Coord(128, 0, 4096 - 128), 8, false);
  volume.grids().all = {sphere, coverage, id};
  writeVolume(folder / "a.vdb", volume, progress);
  const Volume whole = readVolume(folder / "a.vdb", progress);
  const std::vector<GridInfo> expected = describe(whole);
  tbb::task_arena(1).execute([&] {
    const StreamedInfo streamed = describeVolumeFile(folder / "a.vdb", true, progress);
    EXPECT_EQ(streamed.hash, hash(whole));
    for (std::size_t g = 0; g < expected.size(); ++g)
      for (const GridInfo& grid : streamed.grids)
        if (grid.name == expected[g].name)
          test::expectSameCounts(grid, expected[g]);
  });
}

// In a file such names have numbers.
TEST(VolumeStream, NamesMayBeEmptyOrEqual) {
  initializeOpenVDB();
  const TemporaryFolder folder;
  openvdb::GridPtrVec grids;
  for (const char* name : {"b", "", "a", "a"}) {
    grids.push_back(gridWith<openvdb::FloatGrid>(name, float(grids.size())));
    openvdb::gridPtrCast<openvdb::FloatGrid>(grids.back())->tree().setValueOn({}, 7.0F);
  }
  openvdb::io::File(folder / "a.vdb").write(grids);
  Progress progress;
  const StreamedInfo streamed = describeVolumeFile(folder / "a.vdb", true, progress);
  std::vector<std::string> names;
  for (const GridInfo& grid : streamed.grids)
    names.push_back(grid.name);
  EXPECT_EQ(names, (std::vector<std::string>{"", "a", "a", "b"}));
  EXPECT_EQ(streamed.empty.grids().all.front()->getName(), "");
  EXPECT_EQ(streamed.hash, hash(readVolume(folder / "a.vdb", progress)));
}

TEST(VolumeStream, ComparesAsWholes) {
  const TemporaryFolder folder;
  Progress progress;
  writeVolume(folder / "a.vdb", gridsOfAllTypes(), progress);
  Volume other = gridsOfAllTypes();
  auto& grids = other.grids().all;
  auto fog = openvdb::gridPtrCast<openvdb::FloatGrid>(grids[0]);
  fog->tree().setValueOn({3, 4, 5}, 0.5F);
  fog->tree().addTile(3, openvdb::Coord(8192, 0, 0), 1.0F, false);
  fog->tree().setValueOn({-9000, 0, 0}, 7);
  grids[1] = gridWith<openvdb::BoolGrid>("mask", false);
  grids[3]->setName("other");
  grids[5]->setTransform(makeTransform({{0.2, 0.2, 0.2}, {0, 0, 0}}));
  writeVolume(folder / "b.vdb", other, progress);
  for (const char* name : {"a.vdb", "b.vdb"}) {
    const VolumeComparison a = compareVolumeFiles(folder / "a.vdb", folder / name, progress);
    const VolumeComparison b =
        compareVolumes(readVolume(folder / "a.vdb", progress), readVolume(folder / name, progress));
    EXPECT_EQ(a.onlyA, b.onlyA);
    EXPECT_EQ(a.onlyB, b.onlyB);
    EXPECT_EQ(a.incomparable, b.incomparable);
    EXPECT_EQ(a.sameTransform, b.sameTransform);
    EXPECT_EQ(a.sameHash, b.sameHash);
    EXPECT_EQ(a.same(), b.same());
    for (const GridComparison& one : b.grids) {
      const auto found = std::find_if(a.grids.begin(), a.grids.end(),
                                      [&](const auto& grid) { return grid.name == one.name; });
      ASSERT_NE(found, a.grids.end());
      EXPECT_EQ(found->activeA, one.activeA) << one.name;
      EXPECT_EQ(found->activeB, one.activeB) << one.name;
      EXPECT_EQ(found->activeBoth, one.activeBoth) << one.name;
      EXPECT_EQ(found->stateDiffers, one.stateDiffers) << one.name;
      EXPECT_EQ(found->valueDiffers, one.valueDiffers) << one.name;
      EXPECT_EQ(found->largestDifference, one.largestDifference) << one.name;
    }
  }
}

TEST(VolumeStream, RefusesFilesThatAreCutOrNoVolumes) {
  const TemporaryFolder folder;
  Progress progress;
  writeVolume(folder / "a.vdb", gridsOfAllTypes(), progress);
  const std::string bytes = test::fileBytes(folder / "a.vdb");
  for (const std::size_t size :
       {bytes.size() - 1, bytes.size() / 2, std::size_t(300), std::size_t(20), std::size_t(0)}) {
    std::ofstream(folder / "cut.vdb", std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(size));
    EXPECT_FALSE(canStreamVolume(folder / "cut.vdb"));
    EXPECT_THROW(describeVolumeFile(folder / "cut.vdb", false, progress), Error);
  }
  EXPECT_FALSE(canStreamVolume(folder / "none.vdb"));
}

} // namespace
} // namespace tetvdb
