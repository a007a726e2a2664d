// SPDX-License-Identifier: Apache-2.0
//
// .nvdb files that are streamed have the bytes of those that are made of whole trees in memory.
#include "StreamFixture.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/pipeline/ConvertJob.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/LevelsOfDetail.h"

#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;
using namespace meshes;
using Kinds = std::vector<GridKind>;

class StreamNvdb : public StreamFixture {
protected:
  template <class Mesh>
  VoxelizeJob nvdb(const Mesh& mesh, const Kinds& kinds) {
    VoxelizeJob made = job(mesh);
    made.output = folder_ / "a.nvdb";
    made.grids = kinds;
    return made;
  }
  void expectRefused(const VoxelizeJob& job, Status status, const std::string& words) {
    Report report;
    try {
      run(job, report, progress_);
      ADD_FAILURE() << words;
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), status) << error.what();
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
    EXPECT_TRUE(report.stages.empty());
    EXPECT_FALSE(fs::exists(job.output));
  }
};

const Kinds kAll{GridKind::Density, GridKind::Mask, GridKind::Surface, GridKind::Fog,
                 GridKind::Coverage};

TEST_F(StreamNvdb, EachKindOfTriangles) {
  const TriangleMesh balls = joined({sphere({0, 0, 0}, 140, 16), sphere({60, 30, -20}, 120, 16)});
  for (const GridKind kind : kAll)
    expectSame(nvdb(balls, {kind}), std::string(infoOf(kind).name), {2});
  VoxelizeJob half = nvdb(balls, kAll);
  half.half = true;
  half.voxelize.rule = VoxelRule::Centre;
  expectSame(half, "all, half");
  VoxelizeJob any = nvdb(balls, {GridKind::Mask, GridKind::Density});
  any.voxelize.rule = VoxelRule::Any;
  expectSame(any, "by the rule any", {2});
}

TEST_F(StreamNvdb, SeveralCubesByAnyLimit) {
  VoxelizeJob wanted =
      nvdb(joined({rod(6000, 12, {-3000, -2600, -2000}), sphere({4090, 10, -5}, 90, 16)}), kAll);
  expectSame(wanted, "no limit", {2});
  for (const std::size_t limit : {110u, 200u}) {
    limit_ = limit << 20;
    expectSame(wanted, "a limit of " + std::to_string(limit) + " MB", {2});
  }
}

TEST_F(StreamNvdb, OpenTriangles) {
  const TriangleMesh open =
      without(sphere({4095, -20, 4090}, 70, 20), [](std::size_t face) { return face % 800 < 60; });
  expectSame(nvdb(open, {GridKind::Surface, GridKind::Mask}), "a ball with holes", {2});
}

TEST_F(StreamNvdb, OwnersAndFieldsOfTets) {
  TetMesh mesh = mapped(kuhnGrid(40, 2, 2), [](const Vec3d& q) {
    return Vec3d{q[0] * 30 - 600, q[1] * 16 + 0.3 * q[0], q[2] * 16 + 4090};
  });
  std::vector<float> velocity;
  Random random(3);
  for (std::size_t i = 0; i < 3 * mesh.points.size(); ++i)
    velocity.push_back(static_cast<float>(random.between(-4, 4)));
  mesh.attributes.push_back({"vel", Attribute::On::Points, 3, std::move(velocity)});
  expectSame(nvdb(mesh, {GridKind::TetId, GridKind::Material}), "owners");
  VoxelizeJob fields = nvdb(mesh, {GridKind::Density, GridKind::Surface});
  fields.fields.all = true;
  expectSame(fields, "an array and grids", {2});
  fields.grids = {};
  limit_ = std::size_t(110) << 20;
  expectSame(fields, "an array, by a limit", {2});
  limit_ = 0;
  expectSame(nvdb(mesh, {GridKind::Mask}), "mask of tets", {2});
}

TEST_F(StreamNvdb, TilesAloneAreOpenedAtTheFirst) {
  expectSame(nvdb(box({-128.5, -0.5, 127.5}, {255.5, 255.5, 383.5}),
                  {GridKind::Density, GridKind::Surface, GridKind::Coverage, GridKind::Mask}),
             "a box", {2});
  expectSame(nvdb(box({-4096.5, -0.5, 4095.5}, {-0.5, 4095.5, 8191.5}), {GridKind::Mask}),
             "a tile of 4096", {2});
}

TEST_F(StreamNvdb, HoldsWhatTheVdbFileHolds) {
  VoxelizeJob wanted = nvdb(sphere({4000, 7, 8190}, 150, 20), {GridKind::Surface, GridKind::Mask});
  make(wanted, Streaming::Always);
  const Volume nano = readVolume(wanted.output, progress_);
  wanted.output = folder_ / "a.vdb";
  make(wanted, Streaming::Never);
  EXPECT_EQ(hash(nano), hash(readVolume(wanted.output, progress_)));
}

TEST_F(StreamNvdb, LevelsOfDetail) {
  const Kinds kinds{GridKind::Density, GridKind::Mask, GridKind::Fog, GridKind::Coverage};
  for (const char* output : {"a.nvdb", "a.vdb"}) {
    VoxelizeJob wanted = nvdb(
        joined({sphere({10, -20, 4080}, 130, 16), rod(6000, 12, {-3000, -2600, -2000})}), kinds);
    wanted.output = folder_ / output;
    wanted.levels = {1, 12};
    expectSame(wanted, "of several cubes");
    limit_ = std::size_t(250) << 20;
    wanted.levels = {2, 9};
    wanted.half = true;
    expectSame(wanted, "as half, by a limit", {2});
    limit_ = 0;
    fs::remove(folder_ / output);
    wanted = nvdb(box({-128.5, -0.5, 127.5}, {255.5, 255.5, 383.5}),
                  {GridKind::Mask, GridKind::Coverage});
    wanted.output = folder_ / output;
    wanted.levels = {1, 9};
    expectSame(wanted, "tiles alone, of which the first is opened", {2});
    fs::remove(folder_ / output);
  }
  VoxelizeJob full = nvdb(box({-4096.5, -0.5, 4095.5}, {-0.5, 4095.5, 8191.5}), {GridKind::Mask});
  full.levels = {1, 12};
  expectSame(full, "a tile of 4096", {2});
}

TEST_F(StreamNvdb, LevelsOfFields) {
  TetMesh mesh = mapped(kuhnGrid(40, 2, 2), [](const Vec3d& q) {
    return Vec3d{q[0] * 30 - 600, q[1] * 16 + 0.3 * q[0], q[2] * 16 + 4090};
  });
  std::vector<float> velocity, heat;
  Random random(4);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    heat.push_back(static_cast<float>(random.between(-4, 4)));
    for (int k = 0; k < 3; ++k)
      velocity.push_back(static_cast<float>(random.between(-4, 4)));
  }
  mesh.attributes.push_back({"vel", Attribute::On::Points, 3, std::move(velocity)});
  mesh.attributes.push_back({"heat", Attribute::On::Points, 1, std::move(heat)});
  VoxelizeJob fields = nvdb(mesh, {GridKind::Density, GridKind::Coverage});
  fields.fields.all = true;
  fields.levels = {1, 8};
  expectSame(fields, "arrays and grids");
  fields.grids = {};
  limit_ = std::size_t(260) << 20;
  expectSame(fields, "arrays, by a limit", {2});
}

TEST_F(StreamNvdb, LevelsThatDoNotFitLeaveNothing) {
  VoxelizeJob wanted = nvdb(sphere({0, 0, 0}, 500, 40), {GridKind::Mask});
  wanted.streaming = Streaming::Always;
  wanted.levels = {1, 3};
  wanted.maxMemory = residentBytes() + (std::size_t(60) << 20);
  Report report;
  try {
    run(wanted, report, progress_);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Limit) << error.what();
    EXPECT_NE(std::string(error.what()).find("coarser level"), std::string::npos) << error.what();
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
}

TEST_F(StreamNvdb, LevelsOfAFileThatIsConvertedNodeByNode) {
  VoxelizeJob wanted =
      nvdb(sphere({4090, 7, -5}, 150, 20), {GridKind::Mask, GridKind::Density, GridKind::Coverage});
  make(wanted, Streaming::Never);
  Volume whole = readVolume(wanted.output, progress_);
  addLevels(whole, {1, 12}, 0, progress_);
  ASSERT_EQ(whole.grids().all.size(), 39u);
  for (const char* output : {"b.nvdb", "b.vdb"}) {
    ConvertJob job;
    job.isVolume = true;
    job.input = wanted.output;
    job.output = folder_ / output;
    job.levels = {1, 12};
    job.maxMemory = residentBytes() + (std::size_t(100) << 20); // parts of 25 MB
    Report report;
    const ConvertResult result = run(job, report, progress_);
    EXPECT_EQ(report.stages.front().name, "write"); // nothing is read whole
    Volume found = readVolume(job.output, progress_);
    EXPECT_EQ(hash(found), hash(whole));
    const std::vector<GridInfo> infos = describe(found);
    ASSERT_EQ(result.grids.size(), infos.size());
    for (const GridInfo& made : result.grids) { // a .vdb file is read in order of the names
      const auto info = std::find_if(infos.begin(), infos.end(),
                                     [&](const GridInfo& one) { return one.name == made.name; });
      ASSERT_NE(info, infos.end()) << made.name;
      EXPECT_EQ(made.activeVoxels, info->activeVoxels) << made.name;
      EXPECT_EQ(made.leaves, info->leaves) << made.name;
    }
    job.input = job.output; // which has grids of the names of the levels
    job.output = folder_ / "c.vdb";
    EXPECT_THROW(run(job, report, progress_), Error);
    EXPECT_FALSE(fs::exists(job.output));
  }
}

TEST_F(StreamNvdb, CancelLeavesNothing) {
  expectCancelled(nvdb(rod(9000, 60, {0, 0, 0}), {GridKind::Surface}));
}

TEST_F(StreamNvdb, StreamsByItselfWhereTreesDoNotFit) {
  VoxelizeJob wanted = nvdb(sphere({0, 0, 0}, 420, 40), {GridKind::Surface});
  const std::string expected = make(wanted, Streaming::Never);
  wanted.maxMemory = residentBytes() + (std::size_t(120) << 20);
  Report report;
  run(wanted, report, progress_);
  EXPECT_TRUE(wasStreamed(report));
  EXPECT_TRUE(fileBytes(wanted.output) == expected);
}

TEST_F(StreamNvdb, WhatCannotBeMadeIsRefusedBeforeTheWork) {
  VoxelizeJob wanted = nvdb(sphere({0, 0, 0}, 50, 10), {GridKind::Mask});
  wanted.shard = {1, 4};
  expectRefused(wanted, Status::Usage, "is for .vdb files");
  wanted.shard = {};
  wanted.maskType = MaskType::Mask;
  expectRefused(wanted, Status::Usage, "has no NanoVDB form");
}

} // namespace
} // namespace tetvdb
