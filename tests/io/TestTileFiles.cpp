// SPDX-License-Identifier: Apache-2.0
//
// Every voxel of a volume is in the file of its cube, and in no other.
#include "FileBytes.h"
#include "TemporaryFolder.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/TileFiles.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/volume/Grids.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>
#include <openvdb/tools/Prune.h>
#include <random>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;
using openvdb::Coord;
using openvdb::CoordBBox;

using test::fileBytes;

std::map<std::string, std::string> contentsOf(const std::string& folder) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : fs::directory_iterator(folder))
    contents[entry.path().filename()] = fileBytes(entry.path());
  return contents;
}

template <class GridT>
typename GridT::Ptr named(const char* name, const typename GridT::ValueType& background) {
  auto grid = GridT::create(background);
  grid->setName(name);
  grid->setTransform(makeTransform({{0.5, 0.5, 0.5}, {3, -1, 7}}));
  return grid;
}

template <class T>
T valueOf(int i) {
  if constexpr (std::is_same_v<T, openvdb::Vec3s>)
    return T(float(i), 1, -2);
  else
    return T(i);
}

// Voxels about corners of nodes and root children, tiles of every level, active and not.
template <class GridT>
typename GridT::Ptr anything(const char* name, const typename GridT::ValueType& background,
                             unsigned seed, bool rootTiles = true) {
  using T = typename GridT::ValueType;
  auto grid = named<GridT>(name, background);
  std::mt19937 random(seed);
  auto& tree = grid->tree();
  if (rootTiles) {
    tree.addTile(3, Coord(4096, -4096, 8192), valueOf<T>(5), true);
    tree.addTile(3, Coord(-8192, 0, 0), valueOf<T>(6), false);
  }
  for (int i = 0; i < 4; ++i) {
    const auto any = [&](int step) {
      return (int(random() % (10240u / unsigned(step))) - 5120 / step) * step;
    };
    tree.addTile(2, Coord(any(128), any(128), any(128)), valueOf<T>(10 + i), i % 3 != 0);
    tree.addTile(1, Coord(any(8), any(8), any(8)), valueOf<T>(50 + i), i % 2 != 0);
  }
  for (const int x : {-4097, -4096, -513, -1, 0, 511, 512, 4095, 4096})
    for (const int y : {-1, 0, 1023, 1024})
      for (const int z : {-2049, -2048, -1, 0, 127, 128})
        tree.setValue(Coord(x, y, z), valueOf<T>(x + 2 * y + 3 * z));
  return grid;
}

class TileFiles : public ::testing::Test {
protected:
  void SetUp() override { initializeOpenVDB(); }

  // The grids of every file, with its cube.
  struct Tile {
    CoordBBox box;
    Volume volume;
  };
  std::vector<Tile> read(const std::string& folder) {
    std::vector<Tile> tiles;
    const auto index = nlohmann::json::parse(fileBytes(folder + "/tiles.json"));
    for (const auto& tile : index.at("tiles")) {
      const auto corner = [&](const char* which) {
        const auto& c = tile.at("box").at(which);
        return Coord(c[0], c[1], c[2]);
      };
      tiles.push_back({{corner("min"), corner("max")},
                       readVolume(folder + "/" + tile.at("file").get<std::string>(), progress_)});
    }
    return tiles;
  }

  // Voxel by voxel about the corners of tiles and of leaves' voxels: in the file of their cube, and
  // in another one.
  template <class GridT>
  void expectTiles(const openvdb::GridBase& grid, const std::vector<Tile>& tiles) {
    const auto& whole = static_cast<const GridT&>(grid);
    using T = typename GridT::ValueType;
    auto reader = whole.getConstAccessor();
    std::vector<Coord> places;
    std::mt19937 random(3);
    for (auto entry = whole.cbeginValueAll(); entry; ++entry) {
      const bool dull = !entry.isValueOn() && T(*entry) == whole.background();
      if (random() % (dull ? 256 : entry.isVoxelValue() ? 16 : 1) != 0)
        continue;
      CoordBBox box;
      entry.getBoundingBox(box);
      for (const Coord& corner : {box.min(), box.max(), box.min().offsetBy(-1, 0, 0)})
        places.push_back(corner);
    }
    EXPECT_GT(places.size(), 500u);
    std::uint64_t active = 0;
    std::vector<typename GridT::ConstAccessor> readers;
    for (const Tile& tile : tiles) {
      typename GridT::Ptr part;
      for (const auto& one : tile.volume.grids().all)
        if (one->getName() == whole.getName())
          part = std::dynamic_pointer_cast<GridT>(one);
      ASSERT_TRUE(part);
      EXPECT_EQ(part->getName(), whole.getName());
      EXPECT_EQ(part->background(), whole.background());
      EXPECT_EQ(part->transform(), whole.transform());
      EXPECT_EQ(part->getGridClass(), whole.getGridClass());
      active += part->activeVoxelCount();
      readers.push_back(part->getConstAccessor());
    }
    EXPECT_EQ(active, whole.activeVoxelCount());
    for (const Coord& place : places) {
      T expected{}, found{};
      const bool on = reader.probeValue(place, expected);
      bool has = false;
      const std::size_t other = random() % tiles.size();
      for (std::size_t i = 0; i < tiles.size(); ++i) {
        const bool inside = tiles[i].box.isInside(place);
        has = has || inside;
        if (!inside && i != other)
          continue;
        const bool own = readers[i].probeValue(place, found);
        EXPECT_EQ(own, inside && on) << place << whole.getName();
        EXPECT_EQ(found, inside ? expected : whole.background()) << place << whole.getName();
      }
      if (!has) {
        EXPECT_FALSE(on) << place;
        EXPECT_EQ(expected, whole.background()) << place;
      }
    }
  }

  TemporaryFolder folder_;
  Progress progress_;
};

TEST_F(TileFiles, AllTypesAndSizes) {
  for (const int size : {512, 1024, 2048, 4096}) {
    const bool rootTiles = size > 512; // a tile of 4096^3 is 512 files of 512^3
    Volume volume;
    volume.metadata["source"] = "a test";
    volume.grids().all = {anything<openvdb::FloatGrid>("density", 0, 1, rootTiles),
                          anything<openvdb::BoolGrid>("mask", false, 2, rootTiles),
                          anything<openvdb::Int32Grid>("tet_id", -1, 3, rootTiles),
                          anything<openvdb::Vec3SGrid>("vel", openvdb::Vec3s(0), 4, rootTiles),
                          anything<openvdb::FloatGrid>("surface", 3, 5, rootTiles)};
    volume.grids().all.back()->setGridClass(openvdb::GRID_LEVEL_SET);
    volume.grids().all.back()->setSaveFloatAsHalf(true);
    const std::string path = folder_ / "whole.vdb";
    writeVolume(path, volume, progress_);
    const std::string made = folder_ / ("made" + std::to_string(size));
    const TileFilesInfo info = writeTileFiles(made, size, volume, progress_);
    const std::vector<Tile> tiles = read(made);
    EXPECT_EQ(info.files, tiles.size());
    std::uint64_t bytes = 0;
    for (const auto& [name, content] : contentsOf(made))
      bytes += content.size();
    EXPECT_EQ(info.bytes, bytes);
    const auto& all = volume.grids().all;
    expectTiles<openvdb::FloatGrid>(*all[0], tiles);
    expectTiles<openvdb::BoolGrid>(*all[1], tiles);
    expectTiles<openvdb::Int32Grid>(*all[2], tiles);
    expectTiles<openvdb::Vec3SGrid>(*all[3], tiles);
    const std::vector<GridInfo> whole = describe(volume); // in the order that was given
    for (std::size_t g = 0; g < whole.size(); ++g) {
      EXPECT_EQ(info.grids[g].activeVoxels, whole[g].activeVoxels);
      EXPECT_EQ(info.grids[g].boxMin, whole[g].boxMin);
      EXPECT_EQ(info.grids[g].boxMax, whole[g].boxMax);
      EXPECT_EQ(info.grids[g].minValue, whole[g].minValue);
      EXPECT_EQ(info.grids[g].maxValue, whole[g].maxValue);
    }
    if (size == 1024 || size == 2048)
      continue;
    // A file that is read child by child gives the same.
    const std::string cut = folder_ / ("cut" + std::to_string(size));
    splitVolumeFile(path, {}, cut, size, progress_);
    const auto found = contentsOf(cut);
    EXPECT_EQ(found.size(), tiles.size() + 1);
    Volume again = readVolume(path, progress_);
    const std::string half =
        folder_ / ("half" + std::to_string(size)); // values as the file has them
    writeTileFiles(half, size, again, progress_);
    EXPECT_TRUE(contentsOf(half) == found) << size;
  }
}

TEST_F(TileFiles, ChosenGrids) {
  Volume volume;
  volume.grids().all = {anything<openvdb::FloatGrid>("density", 0, 1),
                        anything<openvdb::BoolGrid>("mask", false, 2)};
  const std::string path = folder_ / "whole.vdb";
  writeVolume(path, volume, progress_);
  const TileFilesInfo info = splitVolumeFile(path, {"mask"}, folder_ / "a", 4096, progress_);
  ASSERT_EQ(info.grids.size(), 1u);
  EXPECT_EQ(info.grids[0].name, "mask");
  EXPECT_THROW(splitVolumeFile(path, {"none"}, folder_ / "b", 4096, progress_), Error);
  EXPECT_FALSE(fs::exists(folder_ / "b"));
}

TEST_F(TileFiles, OtherTransformsAndTypesAreRefused) {
  Volume volume;
  volume.grids().all = {named<openvdb::FloatGrid>("a", 0), named<openvdb::FloatGrid>("b", 0)};
  volume.grids().all[1]->setTransform(makeTransform({{0.25, 0.25, 0.25}, {0, 0, 0}}));
  EXPECT_THROW(writeTileFiles(folder_ / "t", 512, volume, progress_), Error);
  EXPECT_THROW(checkTileFiles(folder_ / "t", 500), Error);
  for (const char* name : {"a", ""}) { // equal names, and none
    volume.grids().all = {named<openvdb::FloatGrid>("a", 0), named<openvdb::FloatGrid>(name, 0)};
    EXPECT_THROW(writeTileFiles(folder_ / "t", 512, volume, progress_), Error);
  }
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(TileFiles, CancelLeavesWhatWasThere) {
  Volume volume;
  volume.grids().all = {anything<openvdb::FloatGrid>("density", 0, 1)};
  writeTileFiles(folder_ / "t", 2048, volume, progress_);
  const auto before = contentsOf(folder_ / "t");
  Progress stopped;
  int checks = 0;
  stopped.onCheck([&] {
    if (++checks == 40)
      stopped.cancel();
  });
  EXPECT_THROW(writeTileFiles(folder_ / "t", 512, volume, stopped), Error);
  EXPECT_TRUE(contentsOf(folder_ / "t") == before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
}

} // namespace
} // namespace tetvdb
