// SPDX-License-Identifier: Apache-2.0
//
// Tiles and levels that are streamed have the bytes of those that are made by OpenVDB's nodes in
// memory.
#include "StreamFixture.h"
#include "TestScale.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/volume/Grids.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <map>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;
using namespace meshes;

using Contents = std::map<std::string, std::string>;

Contents contentsOf(const fs::path& path) {
  Contents contents;
  const auto add = [&](const fs::path& one) { contents[one.filename()] = fileBytes(one); };
  if (!fs::is_directory(path))
    add(path);
  else
    for (const auto& entry : fs::directory_iterator(path))
      add(entry.path());
  return contents;
}

class TileJob : public StreamFixture {
protected:
  template <typename Mesh>
  VoxelizeJob job(const Mesh& mesh) {
    VoxelizeJob job = StreamFixture::job(mesh);
    job.grids = {GridKind::Density, GridKind::Mask};
    return job;
  }

  Contents make(VoxelizeJob job, Streaming streaming, VoxelizeResult& result) {
    job.streaming = streaming;
    Report report;
    result = run(job, report, progress_);
    EXPECT_EQ(wasStreamed(report), streaming == Streaming::Always);
    return contentsOf(job.output);
  }

  void expectSame(VoxelizeJob job, const std::string& what) {
    VoxelizeResult tree, stream;
    const Contents expected = make(job, Streaming::Never, tree);
    job.maxMemory = limit_ > 0 ? residentBytes() + limit_ : 0;
    for (const int threads : threads_) {
      job.threads = threads;
      const Contents found = make(job, Streaming::Always, stream);
      ASSERT_EQ(found.size(), expected.size()) << what;
      for (const auto& [name, bytes] : expected)
        EXPECT_TRUE(found.count(name) == 1 && found.at(name) == bytes) << what << ": " << name;
    }
    EXPECT_EQ(stream.tileFiles, tree.tileFiles);
    ASSERT_EQ(stream.grids.size(), tree.grids.size());
    for (std::size_t g = 0; g < tree.grids.size(); ++g) {
      EXPECT_EQ(stream.grids[g].name, tree.grids[g].name);
      EXPECT_EQ(stream.grids[g].activeVoxels, tree.grids[g].activeVoxels) << what;
      EXPECT_EQ(stream.grids[g].minValue, tree.grids[g].minValue) << what;
      EXPECT_EQ(stream.grids[g].maxValue, tree.grids[g].maxValue) << what;
      EXPECT_EQ(stream.grids[g].boxMin, tree.grids[g].boxMin) << what;
      EXPECT_EQ(stream.grids[g].boxMax, tree.grids[g].boxMax) << what;
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 2);
  }
  void expectSameTiles(VoxelizeJob job, const std::string& what,
                       const std::vector<int>& sizes = {512, 4096}) {
    job.output = folder_ / "tiles";
    for (const int size : sizes) {
      job.tileSize = size;
      expectSame(job, what + ", " + std::to_string(size));
    }
  }

  std::vector<int> threads_ = test::threadCounts({1, 3});
};

TriangleMesh aligned(const Vec3d& low, const Vec3d& high) {
  return box({low[0] - 0.5, low[1] - 0.5, low[2] - 0.5},
             {high[0] - 0.5, high[1] - 0.5, high[2] - 0.5});
}

TEST_F(TileJob, StreamedTilesAreTheSame) {
  const TriangleMesh rod = moved(box({0, 0, 0}, {5000, 20, 20}), [](const Vec3d& p) {
    return Vec3d{p[0] * 0.8 - p[1] * 0.6 - 2600, p[0] * 0.48 + p[1] * 0.64 - p[2] * 0.6 - 1000,
                 p[0] * 0.36 + p[1] * 0.48 + p[2] * 0.8 - 500};
  });
  for (const int size : {512, 1024, 2048, 4096}) {
    VoxelizeJob wanted = job(joined({rod, sphere({300, 200, 4100}, 150, 20)}));
    wanted.output = folder_ / "tiles";
    wanted.tileSize = size;
    expectSame(wanted, "a rod and a ball");
    threads_ = {2};
  }
  VoxelizeJob wanted =
      job(joined({aligned({-4096, 0, 0}, {4096, 4096, 4096}), sphere({-2000, 1000, 2000}, 90, 8)}));
  wanted.output = folder_ / "tiles";
  wanted.tileSize = 2048;
  expectSame(wanted, "full cubes, one with a ball in it");
  wanted.tileSize = 4096;
  wanted.voxelize.rule = VoxelRule::Any;
  expectSame(wanted, "the same, any");
}

TEST_F(TileJob, StreamedLevelsAreTheSame) {
  VoxelizeJob wanted =
      job(joined({sphere({10, -20, 4080}, 130, 16), sphere({90, 0, 4100}, 90, 12)}));
  wanted.output = folder_ / "levels.vdb";
  wanted.levels = {1, 12};
  expectSame(wanted, "balls at the corner of four cubes");
  wanted.half = true;
  wanted.levels = {3, 4};
  expectSame(wanted, "as half");
  wanted = job(aligned({-128, 0, 128}, {256, 256, 384}));
  wanted.output = folder_ / "levels.vdb";
  wanted.levels = {1, 9};
  expectSame(wanted, "tiles alone, of which the first is opened");
  wanted = job(aligned({-4096, 0, 4096}, {4096, 4096, 8192}));
  wanted.output = folder_ / "levels.vdb";
  wanted.levels = {1, 6};
  expectSame(wanted, "full cubes");
}

TEST_F(TileJob, LevelsOfTilesAreThoseOfTheWhole) {
  for (const bool aligned512 : {false, true}) {
    VoxelizeJob wanted =
        job(aligned512
                ? aligned({-4096, 0, 4096}, {512, 4096, 8704})
                : joined({sphere({10, -20, 4080}, 130, 16), sphere({700, 30, 4100}, 333.3, 24)}));
    wanted.output = folder_ / "whole.vdb";
    wanted.levels = {1, 9};
    VoxelizeResult result;
    make(wanted, Streaming::Never, result);
    std::map<std::string, openvdb::GridBase::Ptr> whole;
    const Volume all = readVolume(wanted.output, progress_);
    for (const auto& grid : all.grids().all)
      whole[grid->getName()] = grid;
    fs::remove(wanted.output);
    wanted.output = folder_ / "tiles";
    wanted.tileSize = aligned512 ? 2048 : 512;
    expectSame(wanted, "levels of tiles");
    std::map<std::string, std::uint64_t> voxels;
    for (const auto& file : fs::directory_iterator(wanted.output)) {
      if (file.path().extension() != ".vdb")
        continue;
      const Volume tile = readVolume(file.path().string(), progress_);
      const openvdb::GridPtrVec& grids = tile.grids().all;
      EXPECT_EQ(grids.size(), 20u);
      for (const auto& grid : grids) {
        const auto& other = whole.at(grid->getName());
        EXPECT_EQ(grid->transform(), other->transform());
        voxels[grid->getName()] += grid->activeVoxelCount();
        if (grid->getName() == "mask")
          continue;
        const auto& fine = static_cast<const openvdb::FloatGrid&>(*other);
        const auto reader = fine.getConstAccessor();
        for (auto each = static_cast<const openvdb::FloatGrid&>(*grid).cbeginValueOn(); each;
             ++each) {
          openvdb::CoordBBox box;
          each.getBoundingBox(box);
          for (const openvdb::Coord& at : {box.min(), box.max()}) {
            float value = 0;
            ASSERT_TRUE(reader.probeValue(at, value));
            ASSERT_EQ(value, *each) << grid->getName() << at;
          }
        }
      }
    }
    for (const auto& [name, grid] : whole)
      EXPECT_EQ(voxels[name], grid->activeVoxelCount()) << name;
    fs::remove_all(wanted.output);
  }
}

class TreeTiles : public TileJob {
protected:
  TreeTiles() { threads_ = test::threadCounts({1, 7}); }
};

using Kinds = std::vector<GridKind>;

TEST_F(TreeTiles, ShapesOfClosedTriangles) {
  VoxelizeJob rods =
      job(joined({rod(3000, 12, {-1500, -1300, -1000}), sphere({4090, 10, -5}, 90, 16)}));
  for (const Kinds& kinds :
       {Kinds{GridKind::Surface}, Kinds{GridKind::Fog}, Kinds{GridKind::Coverage},
        Kinds{GridKind::Coverage, GridKind::Mask, GridKind::Surface}}) {
    rods.grids = kinds;
    expectSameTiles(rods, std::string(infoOf(kinds.front()).name));
    threads_ = {2};
  }
  rods.half = true;
  rods.maskType = MaskType::Mask;
  expectSameTiles(rods, "half and MaskGrid", {1024, 2048});
  rods.half = false;
  rods.grids = {GridKind::Density, GridKind::Surface, GridKind::Fog, GridKind::Coverage};
  limit_ = std::size_t(200) << 20;
  expectSameTiles(rods, "by a limit");
}

TEST_F(TreeTiles, ShapesOfOpenTriangles) {
  VoxelizeJob open = job(
      without(sphere({10, 20, 4090}, 100, 20), [](std::size_t face) { return face % 800 < 60; }));
  open.grids = {GridKind::Surface, GridKind::Fog};
  expectSameTiles(open, "a ball with holes", {512});
  threads_ = {2};
  expectSameTiles(open, "a ball with holes", {4096});
}

// Nodes without leaves, of which a file has one opened: in a file that has nothing but one tile, in
// one beside nodes of 8^3 voxels, and where the first tile is not in the first node.
TEST_F(TreeTiles, TilesAloneAreOpenedInEveryFile) {
  threads_ = {2};
  const std::vector<int> all{512, 1024, 2048, 4096};
  VoxelizeJob large = job(aligned({-4096, 0, 4096}, {4096, 4096, 8192}));
  large.grids = {test::scale() > 1 ? GridKind::Coverage : GridKind::Mask, GridKind::Density};
  expectSameTiles(large, "tiles of 4096", {2048, 4096});
  VoxelizeJob small = job(aligned({-128, 0, 896}, {640, 256, 1152}));
  small.grids = {GridKind::Coverage, GridKind::Surface};
  expectSameTiles(small, "tiles of 128", all);
  for (const Vec3d& low : {Vec3d{-8, 504, 0}, Vec3d{8, 120, 8}}) {
    VoxelizeJob leaves = job(joined({aligned(low, {136, 528, 528}), sphere({1500, 0, 0}, 20, 8)}));
    leaves.grids = {GridKind::Coverage, GridKind::Mask};
    expectSameTiles(leaves, "tiles of 8");
  }
}

TEST_F(TreeTiles, TilesOfTetsAreOpenedInEveryFile) {
  threads_ = {2};
  VoxelizeJob tets = job(mapped(kuhnGrid(1, 1, 1), [](const Vec3d& p) {
    return Vec3d{p[0] * 512 - 0.5, p[1] * 512 - 0.5, p[2] * 512 - 0.5};
  }));
  tets.grids = {GridKind::Material, GridKind::Coverage};
  expectSameTiles(tets, "a box of tets");
}

TEST_F(TreeTiles, OwnersAndArraysOfTets) {
  VoxelizeJob wanted = job(turnedBar(70, 30, {-1000, -600, -500}));
  wanted.fields.all = true;
  wanted.grids = {GridKind::TetId, GridKind::Material, GridKind::Mask, GridKind::Surface};
  expectSameTiles(wanted, "a bar", {512});
  threads_ = {2};
  expectSameTiles(wanted, "a bar", {4096});
  limit_ = std::size_t(250) << 20;
  expectSameTiles(wanted, "a bar, by a limit", {1024, 2048});
  wanted.grids = {};
  wanted.half = true;
  expectSameTiles(wanted, "arrays alone, half");
}

TEST_F(TreeTiles, LevelsAreThoseOfEveryFile) {
  threads_ = {2};
  VoxelizeJob balls =
      job(joined({sphere({10, -20, 4080}, 130, 16), sphere({300, 30, 4100}, 133.3, 24)}));
  balls.grids = {GridKind::Fog, GridKind::Coverage, GridKind::Mask};
  for (const auto& [size, last] : {std::pair(512, 9), std::pair(1024, 10), std::pair(4096, 12)}) {
    balls.levels = {1, last};
    expectSameTiles(balls, "balls", {size});
  }
  balls.half = true;
  balls.levels = {2, 5};
  expectSameTiles(balls, "balls, half", {512});
  VoxelizeJob full = job(aligned({-512, 0, 4096}, {640, 512, 4608}));
  full.grids = {GridKind::Coverage};
  full.levels = {1, 9};
  expectSameTiles(full, "tiles");
}

TEST_F(TreeTiles, LevelsOfArraysAreThoseOfEveryFile) {
  threads_ = {2};
  VoxelizeJob tets = job(turnedBar(40, 30, {-500, -300, -200}));
  tets.fields.requests = {{"T", "T", FieldPart::Whole, ""}, {"vel", "vel", FieldPart::Whole, ""}};
  tets.grids = {};
  tets.levels = {1, 9};
  expectSameTiles(tets, "arrays");
}

TEST_F(TreeTiles, CancelLeavesNothing) {
  VoxelizeJob long_ = job(rod(9000, 60, {0, 0, 0}));
  long_.grids = {GridKind::Surface};
  long_.output = folder_ / "tiles";
  long_.tileSize = 512;
  expectCancelled(long_);
}

TEST_F(TileJob, WhatDoesNotGoTogether) {
  VoxelizeJob wanted = job(sphere({0, 0, 0}, 30, 8));
  Report report;
  wanted.output = folder_ / "tiles";
  wanted.tileSize = 512;
  wanted.levels = {1, 10}; // whose voxels are larger than tiles
  EXPECT_THROW(run(wanted, report, progress_), Error);
  wanted.levels = {};
  wanted.shard = {0, 2};
  EXPECT_THROW(run(wanted, report, progress_), Error);
  wanted.shard = {};
  wanted.output = folder_ / "tiles.nvdb";
  EXPECT_THROW(run(wanted, report, progress_), Error);
  wanted.output = folder_.path().string(); // of the input
  EXPECT_THROW(run(wanted, report, progress_), Error);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
}

} // namespace
} // namespace tetvdb
