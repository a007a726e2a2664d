// SPDX-License-Identifier: Apache-2.0
//
// Values that are streamed have the bytes of those that are made by whole trees in memory.
#include "StreamFixture.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/pipeline/StreamTrees.h"
#include "tetvdb/volume/Grids.h"

#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/tools/LevelSetUtil.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;
using namespace meshes;
using Kinds = std::vector<GridKind>;

class StreamTrees : public StreamFixture {};

const Kinds kShapes{GridKind::Density, GridKind::Mask, GridKind::Surface, GridKind::Fog,
                    GridKind::Coverage};

TriangleMesh ballWithHoles(const Vec3d& centre, double radius) {
  return without(sphere(centre, radius, 20), [](std::size_t face) { return face % 800 < 60; });
}

TEST_F(StreamTrees, ShapesOfClosedTriangles) {
  VoxelizeJob ball = job(joined({sphere({0, 0, 0}, 140, 16), sphere({60, 30, -20}, 120, 16)}));
  for (const GridKind kind : kShapes) {
    ball.grids = {kind, GridKind::Surface};
    if (kind == GridKind::Surface)
      ball.grids = {kind};
    expectSame(ball, std::string(infoOf(kind).name), {2});
  }
  ball.grids = kShapes;
  expectSame(ball, "two balls about zero");
  ball.half = true;
  ball.maskType = MaskType::Mask;
  ball.shapes.halfWidth = 7.5;
  expectSame(ball, "half and MaskGrid", {2});
}

// Small limits make parts of slices, of stacks and of nodes.
TEST_F(StreamTrees, ShapesThroughSeveralCubesByAnyLimit) {
  VoxelizeJob wanted =
      job(joined({rod(6000, 12, {-3000, -2600, -2000}), sphere({4090, 10, -5}, 90, 16)}));
  wanted.grids = kShapes;
  expectSame(wanted, "no limit", {2});
  wanted.grids = {GridKind::Coverage, GridKind::Fog};
  expectSame(wanted, "no limit, fog and coverage", {8});
  wanted.grids = kShapes;
  for (const std::size_t limit : {110u, 200u}) {
    limit_ = limit << 20;
    expectSame(wanted, "a limit of " + std::to_string(limit) + " MB", {2});
  }
}

// Shapes that are thinner than the half-width decide the fog's depth.
TEST_F(StreamTrees, FogOfThinShapes) {
  VoxelizeJob thin = job(joined({rod(5000, 3.5, {-2300, -2000, -1500})}));
  thin.grids = {GridKind::Fog};
  thin.shapes.halfWidth = 6;
  expectSame(thin, "a thin rod", {2});
  thin.grids = {GridKind::Surface, GridKind::Fog};
  limit_ = std::size_t(110) << 20;
  expectSame(thin, "a thin rod, by a limit", {2});
}

TEST_F(StreamTrees, FogIsThatOfOpenVDB) {
  for (const double halfWidth : {3.0, 40.0}) {
    VoxelizeJob wanted = job(sphere({5, -7, 4090}, 30, 16));
    wanted.shapes.halfWidth = halfWidth;
    wanted.grids = {GridKind::Surface, GridKind::Fog};
    make(wanted, Streaming::Always);
    openvdb::initialize();
    openvdb::io::File file(wanted.output);
    file.open(false);
    const auto surface = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("surface"));
    const auto fog = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("fog"));
    openvdb::tools::sdfToFogVolume(*surface);
    EXPECT_TRUE(surface->tree().hasSameTopology(fog->tree()));
    EXPECT_EQ(surface->background(), fog->background());
    std::size_t compared = 0;
    for (auto value = surface->cbeginValueAll(); value; ++value, ++compared)
      ASSERT_EQ(*value, fog->tree().getValue(value.getCoord())) << value.getCoord();
    EXPECT_GT(compared, 10000u);
  }
}

TEST_F(StreamTrees, ShapesOfOpenTriangles) {
  VoxelizeJob open = job(ballWithHoles({10, 20, 4090}, 100));
  open.grids = {GridKind::Surface};
  expectSame(open, "a ball with holes");
  open.grids = {GridKind::Mask, GridKind::Fog, GridKind::Surface};
  open.shapes.halfWidth = 5;
  expectSame(open, "a ball with holes, fog", {2});
  limit_ = std::size_t(110) << 20;
  expectSame(open, "a ball with holes, by a limit", {2});
  limit_ = 0;
  open.voxelize.voxelSize = {0, 0, 0};
  open.voxelize.resolution = 150;
  expectSame(open, "of which voxels may become larger", {2});
  // A box without a side and half of another, through several cubes. The hole is not plane.
  VoxelizeJob tube =
      job(without(rod(5000, 20, {-2300, -2000, -1500}), [](std::size_t face) { return face > 8; }));
  tube.grids = {GridKind::Surface};
  expectSame(tube, "a rod without one end", {2});
}

TEST_F(StreamTrees, OtherFillRules) {
  VoxelizeJob other =
      job(joined({sphere({0, 0, 0}, 100, 16), flipped(sphere({40, 0, 0}, 100, 16))}));
  other.grids = {GridKind::Surface, GridKind::Density};
  for (const InsideRule rule : {InsideRule::NonZero, InsideRule::Parity}) {
    other.solid.inside = rule;
    expectSame(other, "two balls, one of them flipped", {2});
  }
}

TEST_F(StreamTrees, OwnersOfTets) {
  const TetMesh overlapping = joined(ball(6, 130, {10, -20, 4080}), ball(5, 90, {60, -20, 4100}));
  VoxelizeJob balls = job(overlapping);
  for (const Kinds& kinds :
       {Kinds{GridKind::TetId}, Kinds{GridKind::Material},
        Kinds{GridKind::TetId, GridKind::Density, GridKind::Material, GridKind::Mask},
        Kinds{GridKind::Surface, GridKind::TetId, GridKind::Coverage}, Kinds{GridKind::Surface},
        Kinds{GridKind::Coverage}}) {
    balls.grids = kinds;
    expectSame(balls, "two balls of tets, " + std::string(infoOf(kinds.front()).name),
               kinds.size() > 1 ? test::threadCounts({1, 7}) : std::vector<int>{2});
  }
  VoxelizeJob long_ = job(turnedBar(70, 30, {-1000, -600, -500}));
  long_.grids = {GridKind::TetId, GridKind::Material, GridKind::Surface};
  expectSame(long_, "a bar", {2});
  limit_ = std::size_t(110) << 20;
  expectSame(long_, "a bar, by a limit", {2});
}

TEST_F(StreamTrees, FieldsOfTets) {
  TetMesh mesh = turnedBar(70, 30, {-1000, -600, -500});
  std::get<std::vector<double>>(mesh.attributes[0].values)[17] = std::nan("");
  VoxelizeJob wanted = job(mesh);
  wanted.grids = {};
  wanted.fields.all = true;
  expectSame(wanted, "all arrays");
  wanted.half = true;
  expectSame(wanted, "all arrays, half", {2});
  wanted.half = false;
  wanted.grids = {GridKind::Density, GridKind::TetId, GridKind::Surface};
  expectSame(wanted, "arrays and grids", {2});
  limit_ = std::size_t(250) << 20;
  expectSame(wanted, "arrays and grids, by a limit", {2});
  limit_ = 0;
  wanted.fields = {};
  wanted.fields.requests = {{"speed", "vel", FieldPart::Magnitude, ""}};
  wanted.grids = {GridKind::Mask};
  wanted.voxelize.rule = VoxelRule::Any;
  expectSame(wanted, "a part of an array, and a rule", {2});
}

// Arrays are packed on their way into a .vdb file alone: what their trees take elsewhere decides.
TEST_F(StreamTrees, ArraysWhoseTreesAreTooLarge) {
  TetMesh mesh = scaled(kuhnGrid(2, 2, 2), 150);
  mesh.attributes.push_back(
      {"T", Attribute::On::Points, 1, std::vector<float>(mesh.points.size(), 7)});
  VoxelizeJob wanted = job(mesh);
  wanted.fields.all = true;
  for (const char* output : {"a.nvdb", "tiles"}) {
    wanted.output = folder_ / output;
    wanted.tileSize = std::string(output) == "tiles" ? 512 : 0;
    wanted.maxMemory = residentBytes() + (std::size_t(90) << 20); // trees: 108 MB and more
    Report report;
    run(wanted, report, progress_);
    EXPECT_TRUE(wasStreamed(report)) << output;
  }
}

// A box whose sides lie between voxels: some of its grids are tiles alone.
TEST_F(StreamTrees, TilesAloneAreOpenedAtTheFirst) {
  VoxelizeJob tiles = job(box({-128.5, -0.5, 127.5}, {255.5, 255.5, 383.5}));
  tiles.grids = {GridKind::Coverage};
  expectSame(tiles, "coverage", {2});
  tiles.grids = {GridKind::Density, GridKind::Surface, GridKind::Coverage, GridKind::Mask};
  expectSame(tiles, "coverage and a level set", {2});
  VoxelizeJob large = job(box({-4096.5, -0.5, 4095.5}, {-0.5, 4095.5, 8191.5}));
  large.grids = {GridKind::Coverage};
  expectSame(large, "a tile of 4096", {2});
}

TEST_F(StreamTrees, TilesOfTetsAreOpenedAtTheFirst) {
  VoxelizeJob tets = job(mapped(kuhnGrid(1, 1, 1), [](const Vec3d& p) {
    return Vec3d{p[0] * 512 - 0.5, p[1] * 512 - 0.5, p[2] * 512 - 0.5};
  }));
  tets.grids = {GridKind::Material, GridKind::Coverage};
  expectSame(tets, "a box of tets", {2});
}

TEST_F(StreamTrees, EmptyResultsAreRefusedAndLeaveNothing) {
  VoxelizeJob nothing = job(sphere({0.5, 0.5, 0.5}, 0.1, 4));
  nothing.grids = {GridKind::Surface};
  EXPECT_THROW(make(nothing, Streaming::Always), Error);
  EXPECT_FALSE(fs::exists(nothing.output));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
  nothing.voxelize.allowEmpty = true;
  expectSame(nothing, "nothing", {2});
  nothing.voxelize.allowEmpty = false;
  nothing.grids = {GridKind::Coverage};
  expectSame(nothing, "less than a voxel", {2});
}

TEST_F(StreamTrees, CancelLeavesNothing) {
  VoxelizeJob long_ = job(rod(9000, 60, {0, 0, 0}));
  long_.grids = {GridKind::Surface};
  expectCancelled(long_);
}

// Where whole trees are refused.
TEST_F(StreamTrees, StreamsByItselfWhereTreesDoNotFit) {
  VoxelizeJob wanted = job(sphere({0, 0, 0}, 420, 40));
  wanted.grids = {GridKind::Surface};
  const std::string expected = make(wanted, Streaming::Never);
  wanted.maxMemory = residentBytes() + (std::size_t(120) << 20);
  wanted.streaming = Streaming::Never;
  Report report;
  try {
    run(wanted, report, progress_);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Limit);
  }
  wanted.maxMemory = residentBytes() + (std::size_t(120) << 20);
  wanted.streaming = Streaming::Auto;
  Report streamed;
  run(wanted, streamed, progress_);
  EXPECT_TRUE(wasStreamed(streamed));
  EXPECT_TRUE(fileBytes(wanted.output) == expected);
}

TEST_F(StreamTrees, RefusesWhatDoesNotFitInParts) {
  VoxelizeJob wanted = job(sphere({0, 0, 0}, 300, 40));
  wanted.grids = kShapes;
  wanted.streaming = Streaming::Always;
  wanted.maxMemory = residentBytes() + (std::size_t(14) << 20);
  Report report;
  try {
    run(wanted, report, progress_);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Limit);
    EXPECT_NE(std::string(error.what()).find("`max_memory`"), std::string::npos) << error.what();
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
}

class TreeShards : public StreamTrees {
protected:
  void expectMerged(const VoxelizeJob& wanted, const std::string& what,
                    const std::vector<unsigned>& counts) {
    const std::string whole = make(wanted, Streaming::Never);
    for (const unsigned count : counts)
      EXPECT_TRUE(merged(makeParts(wanted, count), count) == whole) << what << ", " << count;
  }
};

TEST_F(TreeShards, OfTrianglesAreTheWhole) {
  VoxelizeJob closed =
      job(joined({rod(6000, 12, {-3000, -2600, -2000}), sphere({0, 0, 0}, 50, 8)}));
  closed.grids = {GridKind::Coverage, GridKind::Surface, GridKind::Mask};
  expectMerged(closed, "closed", {2, 7});
  VoxelizeJob open =
      job(joined({ballWithHoles({4095, -20, 4090}, 70), ballWithHoles({-8200, 20, 10}, 40)}));
  open.grids = {GridKind::Surface, GridKind::Fog};
  expectMerged(open, "open", {3});
}

TEST_F(TreeShards, OfTetsAreTheWhole) {
  VoxelizeJob wanted = job(turnedBar(70, 30, {-1000, -600, -500}));
  wanted.grids = {GridKind::TetId, GridKind::Material, GridKind::Mask, GridKind::Coverage};
  wanted.fields.all = true;
  expectMerged(wanted, "a bar", {2, 7});
  wanted.half = true;
  wanted.grids = {};
  expectMerged(wanted, "a bar, half", {3});
}

TEST_F(TreeShards, OfTilesAloneAreOpenedInTheWhole) {
  VoxelizeJob wanted = job(box({-4096.5, -0.5, -0.5}, {4095.5, 4095.5, 4095.5}));
  wanted.grids = {GridKind::Coverage, GridKind::Mask};
  expectMerged(wanted, "tiles of 4096", {2});
  VoxelizeJob small = job(box({-128.5, -0.5, 127.5}, {255.5, 255.5, 383.5}));
  small.grids = {GridKind::Coverage, GridKind::Surface, GridKind::Density};
  expectMerged(small, "tiles beside leaves", {2});
}

TEST_F(TreeShards, OfOtherMeshesAreRefused) {
  VoxelizeJob wanted = job(turnedBar(70, 30, {-1000, -600, -500}));
  wanted.grids = {GridKind::TetId};
  std::vector<std::string> parts = makeParts(wanted, 2);
  fs::rename(parts[0], folder_ / "kept.vdb");
  TetMesh other = turnedBar(70, 30, {-1000, -600, -500});
  std::rotate(other.tets.begin(), other.tets.begin() + 4, other.tets.end());
  writeTetMesh(wanted.inputs.front(), other, progress_);
  parts = makeParts(wanted, 2);
  EXPECT_THROW(mergeVdb({folder_ / "kept.vdb", parts[1]}, folder_ / "m.vdb", {}, progress_), Error);
  fs::rename(parts[0], folder_ / "kept.vdb");
  wanted.half = true;
  parts = makeParts(wanted, 2);
  EXPECT_THROW(mergeVdb({folder_ / "kept.vdb", parts[1]}, folder_ / "m.vdb", {}, progress_), Error);
}

TEST_F(TreeShards, PlansAreWhatIsMade) {
  VoxelizeJob wanted = job(rod(9000, 20, {-4600, -4000, -3000}));
  wanted.grids = {GridKind::Surface};
  expectPlanned(wanted);
}

} // namespace
} // namespace tetvdb
