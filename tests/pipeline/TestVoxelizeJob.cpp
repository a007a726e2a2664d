// SPDX-License-Identifier: Apache-2.0
#include "TemporaryFolder.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

class VoxelizeJobTest : public ::testing::Test {
protected:
  void SetUp() override {
    std::ofstream(path("tet.mesh")) << "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n"
                                       "0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
                                       "Tetrahedra\n1\n1 2 3 4 5\nEnd\n";
  }
  std::string path(const std::string& name) const { return folder_ / name; }
  std::size_t fileCount() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
  }
  VoxelizeJob job() const {
    VoxelizeJob job;
    job.inputs = {path("tet.mesh")};
    job.output = path("tet.vdb");
    job.voxelize.resolution = 32;
    return job;
  }
  Status statusOf(const VoxelizeJob& job) {
    try {
      run(job, report_, progress_);
    } catch (const Error& error) {
      return error.status();
    }
    return Status::Ok;
  }

  TemporaryFolder folder_;
  Report report_;
  Progress progress_;
};

TEST_F(VoxelizeJobTest, WritesAVolumeAndSaysWhatItDid) {
  VoxelizeJob wanted = job();
  wanted.units = "m";
  wanted.threads = 2;
  const VoxelizeResult result = run(wanted, report_, progress_);
  EXPECT_EQ(result.tets, 1u);
  EXPECT_NEAR(result.volume, 1.0 / 6, 1e-12);
  ASSERT_EQ(result.inputs.size(), 1u);
  EXPECT_EQ(result.inputs[0].format, FileFormat::Medit);
  ASSERT_EQ(result.grids.size(), 1u);
  EXPECT_NEAR(result.grids[0].volume, 1.0 / 6, 0.02);
  ASSERT_EQ(result.outputs.size(), 1u);
  EXPECT_EQ(result.outputs[0].bytes, fs::file_size(path("tet.vdb")));
  ASSERT_EQ(report_.stages.size(), 3u);

  const Volume volume = readVolume(path("tet.vdb"), progress_);
  EXPECT_EQ(volume.metadata.at("units"), "m");
  EXPECT_EQ(volume.metadata.at("source"), "tet.mesh");
  EXPECT_EQ(describe(volume).at(0).activeVoxels, result.grids[0].activeVoxels);
}

TEST_F(VoxelizeJobTest, ChecksOutputsBeforeInputs) {
  VoxelizeJob wanted = job();
  wanted.inputs = {path("missing.mesh")};
  wanted.output = path("tet.xyz");
  EXPECT_EQ(statusOf(wanted), Status::Usage);
  wanted.output = path("missing/tet.vdb");
  EXPECT_EQ(statusOf(wanted), Status::Write);
  wanted.output = path("tet.vdb");
  EXPECT_EQ(statusOf(wanted), Status::Invalid);
  EXPECT_EQ(fileCount(), 1u);
}

TEST_F(VoxelizeJobTest, CancelledBeforeItBeginsLeavesNothing) {
  progress_.cancel();
  EXPECT_EQ(statusOf(job()), Status::Cancelled);
  EXPECT_EQ(fileCount(), 1u);
}

TEST_F(VoxelizeJobTest, MeshThatIsLargerThanTheMemoryAllowed) {
  VoxelizeJob wanted = job();
  wanted.maxMemory = 1;
  EXPECT_EQ(statusOf(wanted), Status::Limit);
  EXPECT_EQ(fileCount(), 1u);
}

TEST_F(VoxelizeJobTest, MeshAlone) {
  VoxelizeJob wanted = job();
  wanted.output.clear();
  wanted.meshOutput = path("copy.msh");
  const VoxelizeResult result = run(wanted, report_, progress_);
  ASSERT_EQ(result.outputs.size(), 1u);
  InputInfo info;
  const TetMesh copy = readTets(path("copy.msh"), {}, {}, &info, report_, progress_);
  EXPECT_EQ(copy.tetCount(), 1u);
  EXPECT_EQ(copy.regions, (std::vector<std::int32_t>{5}));
}

} // namespace
} // namespace tetvdb
