// SPDX-License-Identifier: Apache-2.0
//
// Tiles and levels that are streamed have the bytes of those that are made by OpenVDB's nodes in
// memory.
#include "StreamFixture.h"
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
  const auto add = [&](const fs::path& one) { contents[one.filename()] = bytesOf(one); };
  if (!fs::is_directory(path))
    add(path);
  else
    for (const auto& entry : fs::directory_iterator(path))
      add(entry.path());
  return contents;
}

class TileJob : public StreamFixture {
protected:
  VoxelizeJob job(const TriangleMesh& mesh) {
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
    for (const int threads : {1, 3}) {
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
      EXPECT_EQ(stream.grids[g].boxMin, tree.grids[g].boxMin) << what;
      EXPECT_EQ(stream.grids[g].boxMax, tree.grids[g].boxMax) << what;
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 2);
  }
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
