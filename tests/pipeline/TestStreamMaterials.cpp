// SPDX-License-Identifier: Apache-2.0
//
// The materials of several triangle meshes, streamed and in shards, against those of whole trees.
#include "StreamFixture.h"

#include <filesystem>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using namespace meshes;
using Kinds = std::vector<GridKind>;

class StreamMaterials : public StreamFixture {
protected:
  // In a folder that is emptied before.
  VoxelizeJob materials(const std::vector<TriangleMesh>& meshes, const Kinds& kinds) {
    for (const auto& file : std::filesystem::directory_iterator(folder_.path()))
      std::filesystem::remove(file);
    VoxelizeJob made = job(meshes.front());
    for (std::size_t i = 1; i < meshes.size(); ++i) {
      made.inputs.push_back(folder_ / ("mesh" + std::to_string(i) + ".obj"));
      writeTriangles(made.inputs.back(), meshes[i], progress_);
    }
    made.grids = kinds;
    return made;
  }
  void expectMerged(const VoxelizeJob& wanted) {
    const std::string whole = make(wanted, Streaming::Never);
    for (const unsigned count : {2U, 3U})
      EXPECT_TRUE(merged(makeParts(wanted, count), count) == whole) << count;
  }
};

TriangleMesh holed(const Vec3d& centre, double radius) {
  return without(sphere(centre, radius, 20), [](std::size_t face) { return face % 800 < 60; });
}

const Kinds kMany{GridKind::Material, GridKind::Density, GridKind::Mask, GridKind::Surface,
                  GridKind::Coverage};

TEST_F(StreamMaterials, OverlapAndTouch) {
  const std::vector<TriangleMesh> meshes{sphere({0, 0, 0}, 140, 16), sphere({60, 30, -20}, 120, 16),
                                         box({-40.5, -40.5, 100.5}, {215.5, 215.5, 356.5}),
                                         sphere({0, 0, 0}, 60, 12)};
  expectSame(materials(meshes, {GridKind::Material}), "material");
  expectSame(materials(meshes, kMany), "material and others", {2});
  expectSame(materials({meshes.front()}, {GridKind::Material}), "one material", {2});
  VoxelizeJob mask = materials(meshes, {GridKind::Mask, GridKind::Material});
  mask.maskType = MaskType::Mask;
  expectSame(mask, "with a MaskGrid", {2});
  VoxelizeJob nano = materials(meshes, {GridKind::Material, GridKind::Mask});
  nano.output = folder_ / "a.nvdb";
  expectSame(nano, ".nvdb", {2});
}

TEST_F(StreamMaterials, SeveralCubesByALimit) {
  const std::vector<TriangleMesh> meshes{rod(6000, 30, {-3000, -2600, -2000}),
                                         rod(6000, 30, {-2985, -2590, -1990}),
                                         sphere({4090, 10, -5}, 90, 16)};
  VoxelizeJob wanted = materials(meshes, {GridKind::Material, GridKind::Surface});
  expectSame(wanted, "no limit", {2});
  limit_ = std::size_t(150) << 20;
  expectSame(wanted, "a limit", {2});
  expectMerged(wanted);
}

TEST_F(StreamMaterials, OpenMeshesAndTheirResolution) {
  VoxelizeJob open =
      materials({holed({0, 0, 0}, 70), holed({50, 10, 0}, 60), rod(200, 9, {0, 0, 0})},
                {GridKind::Material, GridKind::Surface, GridKind::Fog});
  expectSame(open, "open meshes", {2});
  open.voxelize.voxelSize = {0, 0, 0};
  open.voxelize.resolution = 180;
  expectSame(open, "by a resolution", {2});
  open.shard = {0, 2};
  Report report;
  EXPECT_THROW(run(open, report, progress_), Error);
}

// What is said of each, and of all.
TEST_F(StreamMaterials, WithoutVoxels) {
  const TriangleMesh sheet =
      without(box({0, 0, 0}, {80, 80, 80}), [](std::size_t face) { return face > 1; });
  const TriangleMesh dust = sphere({0.5, 0.5, 0.5}, 0.1, 4);
  expectSame(materials({sphere({0, 0, 0}, 50, 12), dust, sheet}, {GridKind::Material}), "dust",
             {2});
  VoxelizeJob none = materials({dust, sheet}, {GridKind::Material, GridKind::Mask});
  EXPECT_THROW(make(none, Streaming::Always), Error);
  EXPECT_FALSE(std::filesystem::exists(none.output));
  none.voxelize.allowEmpty = true;
  expectSame(none, "nothing", {2});
  none.voxelize.rule = VoxelRule::Any; // material knows of no rule
  for (const Streaming streaming : {Streaming::Always, Streaming::Never}) {
    none.streaming = streaming;
    Report report;
    EXPECT_THROW(run(none, report, progress_), Error);
  }
}

} // namespace
} // namespace tetvdb
