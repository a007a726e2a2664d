// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "TemporaryFolder.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/io/TriangleWriter.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/pipeline/MemoryInput.h"
#include "tetvdb/pipeline/RenderJob.h"
#include "tetvdb/pipeline/RepairJob.h"
#include "tetvdb/pipeline/SliceJob.h"
#include "tetvdb/pipeline/TetrahedralizeJob.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <utility>

namespace tetvdb {
namespace {

CellMesh cellsOf(const TetMesh& tets) {
  CellMesh cells;
  cells.points = tets.points;
  cells.nodes = tets.tets;
  cells.runs.push_back({CellType::Tetra, 4, tets.tetCount(), "tetra", false});
  return cells;
}

class MemoryInputTest : public ::testing::Test {
protected:
  std::string path(const std::string& name) const { return folder_ / name; }

  MemoryInputs triangles(const TriangleMesh& mesh) {
    MemoryInputs memory;
    memory["mesh"].triangles = [mesh, this] {
      ++made_;
      return mesh;
    };
    return memory;
  }

  TemporaryFolder folder_;
  int made_ = 0;
  Report report_;
  Progress progress_;
};

TEST_F(MemoryInputTest, trianglesBecomeTheVolumeOfTheirFile) {
  const TriangleMesh mesh = meshes::sphere({0, 0, 0}, 1, 6);
  writeTriangles(path("mesh.ply"), mesh, progress_);
  VoxelizeJob job;
  job.inputs = {path("mesh.ply")};
  job.output = path("file.vdb");
  job.voxelize.resolution = 50;
  job.grids = {GridKind::Density, GridKind::Surface};
  run(job, report_, progress_);
  job.inputs = {"mesh"};
  job.memory = triangles(mesh);
  job.output.clear();
  job.keep = true;
  const VoxelizeResult result = run(job, report_, progress_);
  ASSERT_TRUE(result.kept);
  EXPECT_EQ(hash(*result.kept), hash(readVolume(path("file.vdb"), progress_)));
  EXPECT_EQ(made_, 1);
  EXPECT_EQ(result.inputs.at(0).path, "mesh");
  EXPECT_EQ(result.inputs.at(0).triangles, mesh.triangleCount());
  EXPECT_TRUE(result.outputs.empty());
  EXPECT_EQ(result.kept->metadata.at("source"), "mesh");
}

TEST_F(MemoryInputTest, tetsWithArraysBecomeTheVolumeOfTheirFileAndAreWrittenToo) {
  TetMesh mesh = meshes::kuhnGrid(3, 3, 3);
  writeTetMesh(path("mesh.vtu"), mesh, progress_);
  VoxelizeJob job;
  job.inputs = {"mesh"};
  job.memory["mesh"].cells = [&] {
    CellMesh cells = cellsOf(mesh);
    Attribute height;
    height.name = "height";
    std::vector<double> values;
    for (const Vec3d& p : mesh.points)
      values.push_back(p[2]);
    height.values = values;
    cells.attributes.push_back(height);
    return cells;
  };
  job.voxelize.resolution = 30;
  job.output = path("memory.vdb");
  job.keep = true;
  job.fields.requests = {{"", "height", FieldPart::Whole, ""}};
  const VoxelizeResult result = run(job, report_, progress_);
  const Volume written = readVolume(job.output, progress_);
  EXPECT_EQ(hash(*result.kept), hash(written));
  EXPECT_EQ(describe(written).size(), 2u);
  job.inputs = {path("mesh.vtu")};
  job.fields = {};
  const std::string fromFile = hash(*run(job, report_, progress_).kept);
  job.inputs = {"mesh"};
  EXPECT_EQ(hash(*run(job, report_, progress_).kept), fromFile);
}

TEST_F(MemoryInputTest, everyJobTakesThem) {
  const TriangleMesh box = meshes::box({0, 0, 0}, {8, 8, 8}, 2);
  TetrahedralizeJob tets;
  tets.inputs = {"mesh"};
  tets.memory = triangles(box);
  tets.keep = true;
  const TetrahedralizeResult made = run(tets, report_, progress_);
  ASSERT_TRUE(made.kept);
  EXPECT_EQ(made.kept->tetCount(), made.mesh.tets);
  EXPECT_GT(made.mesh.tets, 0u);

  RepairJob repair;
  repair.input = "mesh";
  TriangleMesh open = box;
  open.triangles.resize(open.triangles.size() - 3);
  repair.memory = triangles(open);
  repair.keep = true;
  const RepairResult repaired = run(repair, report_, progress_);
  ASSERT_TRUE(repaired.kept);
  EXPECT_EQ(repaired.kept->triangleCount(), box.triangleCount());
  EXPECT_TRUE(repaired.output.path.empty());

  RenderJob render;
  render.inputs = {{"mesh"}};
  render.memory = triangles(box);
  render.keep = true;
  render.picture.width = 64;
  render.picture.height = 48;
  const RenderResult picture = run(render, report_, progress_);
  ASSERT_EQ(picture.kept.size(), 1u);
  EXPECT_EQ(picture.kept[0].width, 64);
  EXPECT_EQ(picture.kept[0].height, 48);

  SliceJob slice;
  slice.inputs = {"mesh"};
  slice.memory = triangles(box);
  slice.keep = true;
  slice.printer.pixels = {20, 16};
  slice.printer.display = {20, 16};
  slice.printer.layerHeight = 1;
  const SliceResult layers = run(slice, report_, progress_);
  ASSERT_EQ(layers.kept.size(), 20u * 16 * 8);
  EXPECT_EQ(std::count(layers.kept.begin(), layers.kept.end(), 255), 512);
  EXPECT_EQ(std::count(layers.kept.begin(), layers.kept.end(), 0), 20 * 16 * 8 - 512);
}

TEST_F(MemoryInputTest, volumesAreInputsToo) {
  VoxelizeJob job;
  job.inputs = {"mesh"};
  job.memory = triangles(meshes::box({0, 0, 0}, {8, 8, 8}));
  job.keep = true;
  job.voxelize.voxelSize = {1, 1, 1};
  const VoxelizeResult result = run(job, report_, progress_);
  RepairJob repair;
  repair.input = "volume";
  repair.memory["volume"].volume = *result.kept;
  repair.isVolume = true;
  repair.keep = true;
  const RepairResult surface = run(repair, report_, progress_);
  EXPECT_NEAR(surface.volumeAfter, 512, 30);
}

TEST_F(MemoryInputTest, whatTheyThrowIsWhatTheJobThrows) {
  VoxelizeJob job;
  job.inputs = {"mesh"};
  job.keep = true;
  job.memory["mesh"].triangles = []() -> TriangleMesh {
    throw Error(Status::Invalid, "mesh", "is spoiled");
  };
  try {
    run(job, report_, progress_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "mesh: is spoiled");
  }
  job.memory["mesh"] = {};
  EXPECT_THROW(run(job, report_, progress_), Error);
}

} // namespace
} // namespace tetvdb
