// SPDX-License-Identifier: Apache-2.0
#include "FileBytes.h"
#include "TemporaryFolder.h"
#include "TestScale.h"
#include "TriangleMeshes.h"
#include "surface/ManifoldCheck.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/io/TriangleReader.h"
#include "tetvdb/io/TriangleWriter.h"
#include "tetvdb/pipeline/RepairJob.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;
using namespace tetvdb::meshes;

// As a program that reads STL would: equal positions are one point.
TriangleMesh welded(const TriangleMesh& soup) {
  std::map<Vec3d, std::uint32_t> numbers;
  TriangleMesh mesh;
  for (const std::uint32_t v : soup.triangles) {
    const auto [entry, isNew] =
        numbers.try_emplace(soup.points[v], static_cast<std::uint32_t>(mesh.points.size()));
    if (isNew)
      mesh.points.push_back(soup.points[v]);
    mesh.triangles.push_back(entry->second);
  }
  return mesh;
}

class RepairJobTest : public ::testing::Test {
protected:
  std::string path(const std::string& name) const { return folder_ / name; }
  std::string write(const std::string& name, const TriangleMesh& mesh) {
    writeTriangles(path(name), mesh, progress_);
    return path(name);
  }
  RepairJob job(const TriangleMesh& mesh, int resolution = 48) {
    RepairJob made;
    made.input = write("in.ply", mesh);
    made.output = path("out.stl");
    made.resolution = resolution;
    return made;
  }
  // Runs the job; its output has to be a manifold whose volume is the one it says.
  RepairResult repaired(const RepairJob& wanted) {
    const RepairResult result = run(wanted, report_, progress_);
    made_ = welded(readTriangles(wanted.output, report_, progress_));
    EXPECT_EQ(manifoldDefect(made_), "");
    EXPECT_EQ(made_.triangleCount(), result.triangles);
    EXPECT_EQ(made_.points.size(), result.vertices);
    EXPECT_NEAR(signedVolume(made_), result.volumeAfter, 1e-5 * result.volumeAfter);
    EXPECT_GT(result.volumeAfter, 0);
    return result;
  }
  std::string failure(const RepairJob& wanted, Status status) {
    try {
      run(wanted, report_, progress_);
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), status) << error.what();
      EXPECT_FALSE(fs::exists(path("out.stl")));
      return error.what();
    }
    ADD_FAILURE() << "no error";
    return "";
  }

  TemporaryFolder folder_;
  Report report_;
  Progress progress_;
  TriangleMesh made_;
};

TEST_F(RepairJobTest, WhatIsInOrderIsLeftAlone) {
  const TriangleMesh ball = sphere({0, 0, 0}, 1, 10);
  RepairJob wanted = job(unwelded(ball));
  const RepairResult result = repaired(wanted);
  EXPECT_FALSE(result.remeshed);
  EXPECT_EQ(result.triangles, ball.triangleCount());
  EXPECT_EQ(result.cleaned.weldedPoints, 3 * ball.triangleCount() - ball.points.size());
  wanted.remesh = true;
  const RepairResult again = repaired(wanted);
  EXPECT_TRUE(again.remeshed);
  EXPECT_NEAR(again.volumeAfter, result.volumeAfter, 0.015);
}

TEST_F(RepairJobTest, InsideOutIsTurnedWithoutRemeshing) {
  const RepairResult result = repaired(job(flipped(torus())));
  EXPECT_FALSE(result.remeshed);
  EXPECT_TRUE(result.cleaned.insideOut);
}

TEST_F(RepairJobTest, HolesAreFilledAndTheRestStays) {
  const TriangleMesh cube = box({0, 0, 0}, {1, 1, 1}, 12);
  const TriangleMesh torn = without(cube, [](std::size_t face) { return face % 97 < 3; });
  const RepairResult result = repaired(job(torn));
  EXPECT_FALSE(result.remeshed);
  EXPECT_GT(result.before->boundaryEdges, 0u);
  EXPECT_NEAR(result.volumeAfter, 1, 1e-6);
  ASSERT_TRUE(result.local && result.local->succeeded);
  EXPECT_EQ(result.changes->kept, torn.triangleCount());
  EXPECT_EQ(result.changes->removed, 0u);
  EXPECT_EQ(result.triangles, torn.triangleCount() + result.changes->added);
  EXPECT_LT(result.distance->aToB.largest, 1e-12);
  EXPECT_TRUE(report_.warnings.empty());
  EXPECT_FALSE(report_.partial);
}

TEST_F(RepairJobTest, OverlappingPartsBecomeOne) {
  const TriangleMesh two =
      joined({box({0, 0, 0}, {1, 1, 1}), box({0.5, 0.2, 0.3}, {1.7, 0.9, 0.8})});
  const RepairResult result = repaired(job(two));
  EXPECT_FALSE(result.remeshed);
  EXPECT_GT(result.before->selfIntersections, 0u);
  EXPECT_GT(result.local->crossings.cutFaces, 0u);
  EXPECT_NEAR(result.volumeBefore, 1 + 1.2 * 0.7 * 0.5, 1e-6);
  EXPECT_NEAR(result.volumeAfter, 1 + 0.7 * 0.7 * 0.5, 1e-6);
  EXPECT_EQ(eulerCharacteristic(made_), 2);
}

TEST_F(RepairJobTest, BoxesThatShareAnEdgeMoveApart) {
  const TriangleMesh two = joined({box({0, 0, 0}, {1, 1, 1}), box({1, 1, 0}, {2, 2, 1})});
  const RepairResult result = repaired(job(two));
  EXPECT_FALSE(result.remeshed);
  EXPECT_EQ(result.local->separatedPoints, 2u);
  EXPECT_NEAR(result.volumeAfter, 2, 1e-5);
}

// A plate of an eighth of a voxel beside a ball: voxels miss it, or make it eight times as thick.
TEST_F(RepairJobTest, ALossOfVolumeIsSaid) {
  TriangleMesh two = joined({box({0, 0, 0}, {1, 1, 0.004}), sphere({0.5, 0.5, 0.5}, 0.1, 12)});
  RepairJob wanted = job(two, 30);
  wanted.remesh = true;
  const RepairResult result = run(wanted, report_, progress_);
  EXPECT_TRUE(result.remeshed);
  EXPECT_TRUE(report_.partial);
  ASSERT_EQ(report_.warnings.size(), 1u);
  EXPECT_EQ(report_.warnings[0].code, "volume-changed");
}

TEST_F(RepairJobTest, FlippedAndDoubledFaces) {
  TriangleMesh mesh = withFacesFlipped(sphere({0, 0, 0}, 1, 12), 0.3);
  append(mesh, box({0.2, 0.2, 3}, {0.4, 0.4, 4}));
  append(mesh, box({0.2, 0.2, 3}, {0.4, 0.4, 4}));
  const RepairResult result = repaired(job(mesh));
  EXPECT_GT(result.cleaned.flippedFaces, 0u);
  EXPECT_GT(result.cleaned.duplicateFaces, 0u);
  EXPECT_FALSE(result.remeshed); // cleaning is enough
}

TEST_F(RepairJobTest, SheetsNeedAThickness) {
  RepairJob wanted = job(sheet(6), 64);
  EXPECT_NE(failure(wanted, Status::Invalid).find("`shell"), std::string::npos);
  wanted.solid.shell = 0.2;
  const RepairResult result = repaired(wanted);
  // A plate, half cylinders along its four sides, quarters of a ball at its corners.
  const double r = 0.1, volume = 0.2 + 4 * kPi / 2 * r * r + 4 * kPi / 3 * r * r * r;
  EXPECT_NEAR(result.volumeAfter, volume, 0.008 * volume);
}

TEST_F(RepairJobTest, TetsAreTheirSurface) {
  RepairJob wanted;
  wanted.input = path("grid.msh");
  wanted.output = path("out.stl");
  writeTetMesh(wanted.input, kuhnGrid(2, 3, 4), progress_);
  const RepairResult result = repaired(wanted);
  EXPECT_EQ(result.source, SolidSource::Tets);
  EXPECT_FALSE(result.remeshed);
  EXPECT_NEAR(result.volumeAfter, 24, 1e-9);

  // Two cubes that share an edge: their points are equal, so that STL cannot keep them apart.
  TetMesh some = kuhnGrid(2, 2, 1);
  some.tets.erase(some.tets.begin() + 24, some.tets.begin() + 72);
  writeTetMesh(wanted.input, some, progress_);
  wanted.resolution = 40;
  const RepairResult touching = repaired(wanted);
  EXPECT_FALSE(touching.remeshed);
  EXPECT_EQ(touching.local->separatedPoints, 2u);
  EXPECT_NEAR(touching.volumeAfter, 2, 1e-5);
}

TEST_F(RepairJobTest, VolumesAreTheirSurface) {
  VoxelizeJob voxels;
  voxels.inputs = {write("ball.ply", sphere({0, 0, 0}, 1, 20))};
  voxels.output = path("ball.vdb");
  voxels.voxelize.resolution = 40;
  voxels.mesher = Mesher::Winding;
  run(voxels, report_, progress_);
  RepairJob wanted;
  wanted.input = voxels.output;
  wanted.isVolume = true;
  wanted.output = path("out.stl");
  const RepairResult result = repaired(wanted);
  EXPECT_EQ(result.source, SolidSource::Volume);
  EXPECT_NEAR(result.volumeAfter, 4 * kPi / 3, 0.1);
  wanted.grid = "mask";
  fs::remove(path("out.stl"));
  EXPECT_NE(failure(wanted, Status::Invalid).find("density"), std::string::npos);
}

TEST_F(RepairJobTest, TheSameFileForAnyNumberOfThreads) {
  const TriangleMesh torn =
      without(torus(1, 0.4, 60, 30), [](std::size_t face) { return face % 301 < 7; });
  const auto bytes = [&](int threads) {
    RepairJob wanted = job(torn, 150);
    wanted.threads = threads;
    run(wanted, report_, progress_);
    return test::fileBytes(wanted.output);
  };
  const std::string one = bytes(1);
  EXPECT_EQ(one, bytes(2));
  EXPECT_GT(one.size(), 10000u);
}

TEST_F(RepairJobTest, EveryFormat) {
  const TriangleMesh torn =
      without(box({0, 0, 0}, {1, 1, 1}, 4), [](std::size_t face) { return face == 5; });
  for (const char* name : {"out.stl", "out.obj", "out.ply", "out.off", "out.3mf"}) {
    RepairJob wanted = job(torn, 20);
    wanted.output = path(name);
    repaired(wanted);
  }
}

TEST_F(RepairJobTest, RefusesOutputsBeforeAnyWork) {
  RepairJob wanted = job(box());
  wanted.output = path("out.vdb");
  EXPECT_NE(failure(wanted, Status::Usage).find(".3mf"), std::string::npos);
  wanted.output = wanted.input;
  failure(wanted, Status::Usage);
  wanted.output = path("none/out.stl");
  failure(wanted, Status::Write);
}

TEST_F(RepairJobTest, CancelledJobsLeaveNothing) {
  const RepairJob wanted = job(sphere());
  progress_.cancel();
  failure(wanted, Status::Cancelled);
}

// Models as they are found, with holes, sheets and crossings.
TEST_F(RepairJobTest, CorpusModelsBecomeManifold) {
  const char* corpus = std::getenv("TETVDB_CORPUS");
  if (corpus == nullptr)
    GTEST_SKIP() << "TETVDB_CORPUS is not set";
  std::vector<const char*> names{"libigl-tutorial-data__truck.obj", "common3d__beetle.obj",
                                 "sofa__raptorProps_25kp.obj", "ManifoldPlus__chair.off"};
  if (test::scale() > 1)
    names.insert(names.end(),
                 {"cgal__pig.stl", "modelnet_samples__airplane_0003.off", "3dv__Deep_Space_1.stl"});
  for (const char* name : names) {
    RepairJob wanted;
    wanted.input = (fs::path(corpus) / "tri" / name).string();
    if (!fs::exists(wanted.input))
      continue;
    wanted.output = path("out.stl");
    wanted.resolution = 100;
    SCOPED_TRACE(name);
    repaired(wanted);
  }
}

} // namespace
} // namespace tetvdb
