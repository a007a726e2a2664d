// SPDX-License-Identifier: Apache-2.0
//
// Jobs that are made both ways, streamed and by OpenVDB's nodes in memory, and by shards.
#pragma once

#include "FileBytes.h"
#include "Meshes.h"
#include "TemporaryFolder.h"
#include "TestScale.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/MergeVdb.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/io/TriangleWriter.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tetvdb {

using test::fileBytes;

inline bool wasStreamed(const Report& report) {
  for (const Stage& stage : report.stages)
    for (const StagePart& part : stage.parts)
      if (part.name == "stream")
        return true;
  return false;
}

class StreamFixture : public ::testing::Test {
protected:
  VoxelizeJob job(const TriangleMesh& mesh) {
    VoxelizeJob job;
    job.inputs = {folder_ / "mesh.obj"};
    writeTriangles(job.inputs.front(), mesh, progress_);
    job.voxelize.voxelSize = {1, 1, 1};
    job.output = folder_ / "a.vdb";
    job.clean.orient = false;
    return job;
  }
  VoxelizeJob job(const TetMesh& mesh) {
    VoxelizeJob job;
    job.inputs = {folder_ / "mesh.vtu"};
    writeTetMesh(job.inputs.front(), mesh, progress_);
    job.voxelize.voxelSize = {1, 1, 1};
    job.output = folder_ / "a.vdb";
    return job;
  }

  std::string make(VoxelizeJob job, Streaming streaming, VoxelizeResult* result = nullptr,
                   std::vector<std::string>* warnings = nullptr) {
    job.streaming = streaming;
    Report report;
    VoxelizeResult made = run(job, report, progress_);
    EXPECT_EQ(wasStreamed(report), streaming == Streaming::Always);
    if (result != nullptr)
      *result = std::move(made);
    if (warnings != nullptr) {
      warnings->clear();
      for (const Warning& warning : report.warnings)
        warnings->push_back(warning.code + ": " + warning.text);
      std::sort(warnings->begin(), warnings->end());
    }
    return fileBytes(job.output);
  }

  // Makes the job both ways.
  void expectSame(VoxelizeJob job, const std::string& what,
                  const std::vector<int>& threadCounts = test::threadCounts({1, 7})) {
    VoxelizeResult tree, stream;
    std::vector<std::string> treeWarnings, streamWarnings;
    const std::string expected = make(job, Streaming::Never, &tree, &treeWarnings);
    job.maxMemory = limit_ > 0 ? residentBytes() + limit_ : 0;
    for (const int threads : threadCounts) {
      job.threads = threads;
      EXPECT_TRUE(make(job, Streaming::Always, &stream, &streamWarnings) == expected)
          << what << ", " << threads << " threads";
      EXPECT_EQ(streamWarnings, treeWarnings) << what;
    }
    ASSERT_EQ(stream.grids.size(), tree.grids.size());
    for (std::size_t g = 0; g < tree.grids.size(); ++g) {
      const GridInfo &a = stream.grids[g], &b = tree.grids[g];
      EXPECT_EQ(a.name, b.name);
      EXPECT_EQ(a.type, b.type);
      EXPECT_EQ(a.gridClass, b.gridClass);
      EXPECT_EQ(a.activeVoxels, b.activeVoxels) << what;
      EXPECT_EQ(a.activeTiles, b.activeTiles) << what;
      EXPECT_EQ(a.leaves, b.leaves) << what;
      EXPECT_EQ(a.bytes, b.bytes) << what;
      if (a.name == "coverage") // a sum of fractions, in another order
        EXPECT_NEAR(a.volume, b.volume, 1e-12 * b.volume) << what;
      else
        EXPECT_EQ(a.volume, b.volume) << what;
      EXPECT_EQ(a.boxMin, b.boxMin) << what;
      EXPECT_EQ(a.boxMax, b.boxMax) << what;
      EXPECT_EQ(a.minValue, b.minValue) << what;
      EXPECT_EQ(a.maxValue, b.maxValue) << what;
      EXPECT_EQ(a.metadata, b.metadata) << what;
      EXPECT_EQ(a.transform.voxelSize, b.transform.voxelSize) << what;
    }
    EXPECT_EQ(stream.openEdges, tree.openEdges);
    EXPECT_EQ(stream.counts.boundaryFaces, tree.counts.boundaryFaces);
    // Nothing is left beside the meshes and the volume.
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()),
                            std::filesystem::directory_iterator()),
              static_cast<std::ptrdiff_t>(job.inputs.size() + 1));
  }

  void expectCancelled(VoxelizeJob job) {
    job.streaming = Streaming::Always;
    Progress progress;
    progress.onReport([&](std::string_view, double fraction) {
      if (fraction > 0.2)
        progress.cancel();
    });
    Report report;
    EXPECT_THROW(run(job, report, progress), Error);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()),
                            std::filesystem::directory_iterator()),
              1);
  }

  static std::size_t residentBytes() {
    std::size_t all = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> all >> resident;
    return resident * 4096;
  }

  // The job's bytes as parts, merged in an order by `seed`.
  std::vector<std::string> makeParts(const VoxelizeJob& whole, unsigned count) {
    std::vector<std::string> parts;
    for (unsigned i = 0; i < count; ++i) {
      VoxelizeJob job = whole;
      job.shard = {i, count};
      job.threads = static_cast<int>(1 + i % 3);
      job.output = folder_ / ("part" + std::to_string(i) + ".vdb");
      Report report;
      run(job, report, progress_);
      parts.push_back(job.output);
    }
    return parts;
  }
  // A plan writes nothing and says where the voxels of each part will be.
  void expectPlanned(VoxelizeJob wanted) {
    wanted.plan = 4;
    Report report;
    const VoxelizeResult planned = run(wanted, report, progress_);
    EXPECT_FALSE(std::filesystem::exists(wanted.output));
    ASSERT_EQ(planned.plan.size(), 4u);
    wanted.plan = 0;
    const std::vector<std::string> parts = makeParts(wanted, 4);
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      sum += planned.plan[i].share;
      const GridInfo made = describe(readVolume(parts[i], progress_)).front();
      for (std::size_t k = 0; made.activeVoxels > 0 && k < 3; ++k) {
        EXPECT_GE(made.boxMin[k], planned.plan[i].boxMin[k]);
        EXPECT_LE(made.boxMax[k], planned.plan[i].boxMax[k]);
      }
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }

  std::string merged(std::vector<std::string> parts, unsigned seed) {
    std::shuffle(parts.begin(), parts.end(), std::mt19937(seed));
    mergeVdb(parts, folder_ / "merged.vdb", {}, progress_);
    return fileBytes(folder_ / "merged.vdb");
  }

  TemporaryFolder folder_;
  Progress progress_;
  std::size_t limit_ = 0; ///< what streamed jobs may take beyond what the tests have; 0: no limit
};

// A rod that is turned, about so many voxels long.
inline TriangleMesh rod(double length, double width, const Vec3d& shift) {
  return meshes::moved(meshes::box({0, 0, 0}, {length, width, width}), [&](const Vec3d& p) {
    return Vec3d{p[0] * 0.8 - p[1] * 0.6 + shift[0],
                 p[0] * 0.48 + p[1] * 0.64 - p[2] * 0.6 + shift[1],
                 p[0] * 0.36 + p[1] * 0.48 + p[2] * 0.8 + shift[2]};
  });
}

// A bar of tets with arrays, turned; `cells` times 2 x 2 cubes of tets.
inline TetMesh turnedBar(int cells, double width, const Vec3d& shift) {
  TetMesh mesh =
      meshes::mapped(meshes::jittered(meshes::kuhnGrid(cells, 2, 2), 0.1, 7), [&](const Vec3d& q) {
        const Vec3d p{q[0] * width, q[1] * width / 2, q[2] * width / 2};
        return Vec3d{p[0] * 0.8 - p[1] * 0.6 + shift[0],
                     p[0] * 0.48 + p[1] * 0.64 - p[2] * 0.6 + shift[1],
                     p[0] * 0.36 + p[1] * 0.48 + p[2] * 0.8 + shift[2]};
      });
  meshes::Random random(3);
  std::vector<double> temperature;
  std::vector<float> velocity;
  std::vector<std::int32_t> kind;
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    temperature.push_back(random.between(-900, 900));
  for (std::size_t i = 0; i < 3 * mesh.points.size(); ++i)
    velocity.push_back(static_cast<float>(random.between(-4, 4)));
  for (std::size_t i = 0; i < mesh.cellCount; ++i)
    kind.push_back(static_cast<std::int32_t>(random.below(9)));
  mesh.attributes.push_back({"T", Attribute::On::Points, 1, std::move(temperature)});
  mesh.attributes.push_back({"vel", Attribute::On::Points, 3, std::move(velocity)});
  mesh.attributes.push_back({"kind", Attribute::On::Cells, 1, std::move(kind)});
  return mesh;
}

} // namespace tetvdb
