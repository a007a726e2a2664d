// SPDX-License-Identifier: Apache-2.0
//
// A file that is streamed has the bytes of one that is made by OpenVDB's nodes in memory.
#include "StreamFixture.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/pipeline/StreamJob.h"
#include "tetvdb/volume/Grids.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <openvdb/io/File.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;
using namespace meshes;

class StreamJob : public StreamFixture {
protected:
  // All kinds of grids and rules.
  void expectSameOfAll(VoxelizeJob job, const std::string& what) {
    using Kinds = std::vector<GridKind>;
    for (const Kinds& kinds : {Kinds{GridKind::Mask}, Kinds{GridKind::Density}}) {
      job.grids = kinds;
      expectSame(job, what, {2});
    }
    job.grids = {GridKind::Density, GridKind::Mask};
    expectSame(job, what);
    job.half = true;
    job.maskType = MaskType::Mask;
    expectSame(job, what + ", half and MaskGrid", {2});
    job.half = false;
    job.maskType = MaskType::Bool;
    for (const VoxelRule rule : {VoxelRule::Any, VoxelRule::All}) {
      job.voxelize.rule = rule;
      expectSame(job, what + (rule == VoxelRule::Any ? ", any" : ", all"), {2});
    }
  }
};

TEST_F(StreamJob, ClosedMeshesInOneCubeAndAcrossZero) {
  expectSameOfAll(job(sphere({200, 210, 220}, 150, 24)), "a ball");
  expectSameOfAll(job(joined({sphere({0, 0, 0}, 140, 16), sphere({60, 30, -20}, 120, 16)})),
                  "two balls that overlap, about zero");
}

TEST_F(StreamJob, RodsThroughSeveralCubes) {
  VoxelizeJob wanted = job(rod(9000, 60, {-4600, -4000, -3000}));
  wanted.grids = {GridKind::Density, GridKind::Mask};
  expectSame(wanted, "a rod");
  wanted.grids = {GridKind::Mask};
  wanted.voxelize.rule = VoxelRule::Any;
  expectSame(wanted, "a rod, any", {2});
}

TEST_F(StreamJob, TetsThatOverlap) {
  const TetMesh mesh = joined(ball(6, 130, {10, -20, 4080}), ball(5, 90, {60, -20, 4100}));
  expectSameOfAll(job(mesh), "two balls of tets");
}

TEST_F(StreamJob, OpenMeshesAndOtherFillRules) {
  const TriangleMesh open =
      without(sphere({10, 20, 4090}, 100, 20), [](std::size_t face) { return face % 800 < 60; });
  expectSameOfAll(job(open), "a ball with holes");
  VoxelizeJob byResolution = job(open);
  byResolution.voxelize.voxelSize = {0, 0, 0};
  byResolution.voxelize.resolution = 150;
  expectSame(byResolution, "of which voxels may become larger", {2});
  VoxelizeJob other =
      job(joined({sphere({0, 0, 0}, 100, 16), flipped(sphere({40, 0, 0}, 100, 16))}));
  for (const InsideRule rule : {InsideRule::NonZero, InsideRule::Parity}) {
    other.solid.inside = rule;
    expectSame(other, "two balls, one of them flipped", {2});
  }
}

// Boxes whose sides lie between voxels.
TEST_F(StreamJob, TilesAloneAreOpenedAtTheFirst) {
  const auto aligned = [](const Vec3d& low, const Vec3d& high) {
    return box({low[0] - 0.5, low[1] - 0.5, low[2] - 0.5},
               {high[0] - 0.5, high[1] - 0.5, high[2] - 0.5});
  };
  expectSame(job(aligned({-8, 0, 8}, {16, 24, 16})), "tiles of leaves");
  expectSame(job(aligned({-128, 0, 128}, {256, 256, 384})), "tiles of 128");
  expectSame(job(aligned({-4096, 0, 4096}, {0, 4096, 12288})), "tiles of 4096", {2});
  expectSame(
      job(joined({aligned({-4096, 0, 4096}, {0, 4096, 8192}), rod(9000, 40, {100, -4000, -3000})})),
      "a tile of 4096 and leaves", {2});
  // Inside everywhere, but with faces in it.
  expectSame(
      job(joined({aligned({0, 0, 0}, {4096, 4096, 4096}), sphere({2000, 1000, 2000}, 90, 8)})),
      "a full tile of 4096 with a ball in it", {2});
}

TEST_F(StreamJob, EmptyResultsAreRefusedAndLeaveNothing) {
  VoxelizeJob nothing = job(sphere({0.5, 0.5, 0.5}, 0.1, 4));
  EXPECT_THROW(make(nothing, Streaming::Always), Error);
  EXPECT_FALSE(fs::exists(nothing.output));
  nothing.voxelize.allowEmpty = true;
  expectSame(nothing, "nothing");
}

TEST_F(StreamJob, CancelLeavesNothing) {
  VoxelizeJob long_ = job(rod(20000, 300, {0, 0, 0}));
  expectCancelled(long_);
}

TEST_F(StreamJob, OpenVDBReadsIt) {
  VoxelizeJob wanted = job(rod(9000, 60, {-5000, -4000, -3000}));
  wanted.grids = {GridKind::Density, GridKind::Mask};
  VoxelizeResult result;
  make(wanted, Streaming::Always, &result);
  openvdb::initialize();
  openvdb::io::File file(wanted.output);
  file.open(false);
  const auto density = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("density"));
  const auto mask = openvdb::gridPtrCast<openvdb::BoolGrid>(file.readGrid("mask"));
  EXPECT_EQ(density->activeVoxelCount(), result.grids[0].activeVoxels);
  EXPECT_EQ(mask->activeVoxelCount(), result.grids[1].activeVoxels);
  EXPECT_TRUE(mask->tree().hasSameTopology(density->tree()));
  EXPECT_EQ(density->evalActiveVoxelBoundingBox().min().x(), result.grids[0].boxMin[0]);
}

// Parts of a job, merged in some order.
class Shards : public StreamJob {
protected:
  Status statusOf(const std::vector<std::string>& parts, std::string& text) {
    try {
      mergeVdb(parts, folder_ / "merged.vdb", {}, progress_);
    } catch (const Error& error) {
      text = error.what();
      return error.status();
    }
    return Status::Ok;
  }
};

TEST_F(Shards, AnyNumberInAnyOrderIsTheWhole) {
  VoxelizeJob wanted =
      job(joined({rod(9000, 60, {-4600, -4000, -3000}), sphere({0, 0, 0}, 50, 8)}));
  wanted.grids = {GridKind::Density, GridKind::Mask};
  const std::string whole = make(wanted, Streaming::Never);
  for (const unsigned count : {2u, 3u, 7u, 16u})
    EXPECT_TRUE(merged(makeParts(wanted, count), count) == whole) << count;
}

TEST_F(Shards, TilesAloneAreOpenedInTheWhole) {
  VoxelizeJob wanted = job(box({-4096.5, -0.5, -0.5}, {8191.5, 4095.5, 4095.5}));
  wanted.grids = {GridKind::Mask, GridKind::Density};
  const std::string whole = make(wanted, Streaming::Never);
  const std::vector<std::string> parts = makeParts(wanted, 2);
  EXPECT_TRUE(merged(parts, 1) == whole);
  for (const std::string& part : parts)
    EXPECT_GT(describe(readVolume(part, progress_)).front().activeVoxels, 0u);
}

// More leaves than the metadata entry for delayed loading is written for.
TEST_F(Shards, AndStreamsOfManyLeaves) {
  TriangleMesh slabs;
  for (int i = 0; i < 8; ++i) // each in one layer of leaves
    append(slabs, box({-1500.2, -1500.2, i * 16 + 2.5}, {1500.3, 1500.3, i * 16 + 4.5}));
  VoxelizeJob many = job(slabs);
  many.grids = {GridKind::Density};
  VoxelizeResult result;
  const std::string expected = make(many, Streaming::Never, &result);
  ASSERT_GT(result.grids.front().leaves, std::uint64_t(1) << 20);
  EXPECT_TRUE(make(many, Streaming::Always) == expected);
  EXPECT_TRUE(merged(makeParts(many, 2), 3) == expected);
}

TEST_F(Shards, AreRefusedByNameWhereTheyDoNotFit) {
  VoxelizeJob wanted = job(rod(9000, 60, {-4600, -4000, -3000}));
  const std::vector<std::string> parts = makeParts(wanted, 3);
  std::string text;
  EXPECT_EQ(statusOf({parts[0], parts[2]}, text), Status::Invalid);
  EXPECT_NE(text.find("1/3"), std::string::npos) << text;
  EXPECT_EQ(statusOf({parts[0], parts[1], parts[2], parts[1]}, text), Status::Invalid);
  EXPECT_NE(text.find("part1.vdb"), std::string::npos) << text;
  const std::string bytes = fileBytes(parts[1]);
  for (const std::size_t size :
       {bytes.size() - 1, bytes.size() / 2, std::size_t(700), std::size_t(60), std::size_t(0)}) {
    std::ofstream(folder_ / "cut.vdb", std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(size));
    EXPECT_EQ(statusOf({parts[0], folder_ / "cut.vdb", parts[2]}, text), Status::Invalid);
    EXPECT_NE(text.find("cut.vdb"), std::string::npos) << text;
  }
  wanted.voxelize.voxelSize = {1.25, 1.25, 1.25};
  fs::rename(parts[1], folder_ / "kept.vdb");
  const std::vector<std::string> others = makeParts(wanted, 3);
  EXPECT_EQ(statusOf({others[0], folder_ / "kept.vdb", others[2]}, text), Status::Invalid);
  EXPECT_NE(text.find("kept.vdb"), std::string::npos) << text;
  make(wanted, Streaming::Always);
  EXPECT_EQ(statusOf({wanted.output}, text), Status::Invalid);
  EXPECT_FALSE(fs::exists(folder_ / "merged.vdb"));
}

TEST_F(Shards, PlansAreWhatIsMade) {
  expectPlanned(job(rod(9000, 60, {-4600, -4000, -3000})));
}

TEST_F(Shards, OfOtherJobsAreRefused) {
  VoxelizeJob wanted = job(sphere({0, 0, 0}, 50, 8));
  wanted.shard = {0, 2};
  std::vector<VoxelizeJob> jobs(4, wanted);
  jobs[0].solid.inside = InsideRule::Flood;
  jobs[1].output = folder_ / "a.nvdb";
  jobs[2].solid.shell = 3;
  jobs[3].keep = true;
  for (const VoxelizeJob& one : jobs) {
    Report report;
    try {
      run(one, report, progress_);
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), Status::Usage);
    }
  }
}

} // namespace
} // namespace tetvdb
