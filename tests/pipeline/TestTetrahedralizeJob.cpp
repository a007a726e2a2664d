// SPDX-License-Identifier: Apache-2.0
#include "FileBytes.h"
#include "TemporaryFolder.h"
#include "TestScale.h"
#include "TriangleMeshes.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/io/TriangleWriter.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/pipeline/TetrahedralizeJob.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;
using namespace tetvdb::meshes;

class TetrahedralizeJobTest : public ::testing::Test {
protected:
  std::string path(const std::string& name) const { return folder_ / name; }
  std::string write(const std::string& name, const TriangleMesh& mesh) {
    writeTriangles(path(name), mesh, progress_);
    return path(name);
  }
  TetrahedralizeJob job(const TriangleMesh& mesh) {
    TetrahedralizeJob made;
    made.inputs = {write("in.ply", mesh)};
    made.output = path("out.msh");
    return made;
  }
  TetMesh read(const std::string& file) {
    return readTets(file, {}, {}, nullptr, report_, progress_);
  }
  Status statusOf(const TetrahedralizeJob& wanted) {
    try {
      run(wanted, report_, progress_);
    } catch (const Error& error) {
      EXPECT_FALSE(fs::exists(path("out.msh")));
      return error.status();
    }
    return Status::Ok;
  }

  TemporaryFolder folder_;
  Report report_;
  Progress progress_;
};

// Volumes of tets by the region that their cell is in.
std::map<std::int32_t, double> volumes(const TetMesh& mesh) {
  std::map<std::int32_t, double> sums;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    TriangleMesh faces;
    faces.points = mesh.points;
    const std::uint32_t* v = &mesh.tets[4 * t];
    faces.triangles = {v[0], v[2], v[1], v[0], v[1], v[3], v[1], v[2], v[3], v[0], v[3], v[2]};
    sums[mesh.regions.empty() ? 0 : mesh.regions[mesh.cell(t)]] += signedVolume(faces);
  }
  return sums;
}

TEST_F(TetrahedralizeJobTest, WritesTetsAndSaysWhatTheyAre) {
  TetrahedralizeJob wanted = job(unwelded(sphere({0, 0, 0}, 1, 10)));
  wanted.epsilon = {5e-3, RelativeLength::Unit::Diagonal};
  wanted.threads = 2;
  const TetrahedralizeResult result = run(wanted, report_, progress_);
  // The diagonal of the box of the octahedron's six corners.
  EXPECT_NEAR(result.mesh.made.epsilonAsked, 5e-3 * std::sqrt(12.0), 1e-6);
  EXPECT_GT(result.cleaned.at(0).weldedPoints, 0u);
  EXPECT_EQ(result.cleanedFaces.at(0), 800u);
  EXPECT_EQ(result.mesh.made.mesh.tetCount(), 0u);
  EXPECT_EQ(result.output.bytes, fs::file_size(path("out.msh")));
  std::vector<std::string> stages;
  for (const Stage& stage : report_.stages)
    stages.push_back(stage.name);
  EXPECT_EQ(stages, (std::vector<std::string>{"read", "clean", "tetrahedralize", "write"}));

  const TetMesh made = read(path("out.msh"));
  EXPECT_EQ(made.tetCount(), result.mesh.tets);
  EXPECT_EQ(made.points.size(), result.mesh.vertices);
  EXPECT_EQ(result.mesh.statistics.inverted, 0u);
  EXPECT_NEAR(volumes(made).at(1), signedVolume(sphere({0, 0, 0}, 1, 10)),
              1.1 * 4 * kPi * result.mesh.made.epsilonAsked);
  EXPECT_NEAR(volumes(made).at(1), result.mesh.statistics.volume, 1e-9);
  EXPECT_GT(result.mesh.boxOverVolume(), 3);
}

TEST_F(TetrahedralizeJobTest, EveryFormatKeepsRegions) {
  TetrahedralizeJob wanted;
  fs::create_directory(folder_ / "sub");
  wanted.inputs = {write("part.ply", box()), write("sub/part.ply", box({3, 0, 0}, {4, 1, 1}))};
  for (const char* name : {"out.msh", "out.mesh", "out.vtu"}) {
    wanted.output = path(name);
    const TetrahedralizeResult result = run(wanted, report_, progress_);
    EXPECT_EQ(result.regionNames,
              (std::map<std::int32_t, std::string>{{1, "part"}, {2, "part_2"}}));
    const TetMesh made = read(wanted.output);
    const auto found = volumes(made);
    ASSERT_EQ(found.size(), 2u) << name;
    for (const std::int32_t region : {1, 2}) {
      EXPECT_NEAR(found.at(region), 1, 6.6 * result.mesh.made.epsilonAsked);
      EXPECT_GT(result.mesh.tetsOfRegion.at(region), 0u);
    }
    if (std::string(name) == "out.msh") {
      EXPECT_EQ(made.regionNames, result.regionNames);
    }
  }
}

TEST_F(TetrahedralizeJobTest, OutsideIsRegionZeroInEveryFormat) {
  TetrahedralizeJob wanted = job(box());
  wanted.mesher.keepOutside = true;
  for (const char* name : {"out.msh", "out.mesh", "out.vtu"}) {
    wanted.output = path(name);
    const TetrahedralizeResult result = run(wanted, report_, progress_);
    const auto found = volumes(read(wanted.output));
    ASSERT_EQ(found.size(), 2u) << name;
    EXPECT_GT(found.at(0), 0);
    EXPECT_NEAR(found.at(1), 1, 6.6 * result.mesh.made.epsilonAsked);
  }
}

TEST_F(TetrahedralizeJobTest, BooleansAreOneRegion) {
  TetrahedralizeJob wanted;
  wanted.inputs = {write("a.ply", box()), write("b.ply", box({0.5, 0.5, 0.5}, {1.5, 1.5, 1.5}))};
  wanted.output = path("out.msh");
  const std::map<Boolean, std::pair<std::string, double>> truth = {
      {Boolean::Union, {"union", 1.875}},
      {Boolean::Difference, {"difference", 0.875}},
      {Boolean::Intersection, {"intersection", 0.125}}};
  for (const auto& [boolean, expected] : truth) {
    wanted.mesher.boolean = boolean;
    const TetrahedralizeResult result = run(wanted, report_, progress_);
    const TetMesh made = read(wanted.output);
    EXPECT_EQ(made.regionNames.at(1), expected.first);
    EXPECT_NEAR(volumes(made).at(1), expected.second, 13 * result.mesh.made.epsilonAsked);
    EXPECT_EQ(result.mesh.tetsOfRegion.size(), 1u);
  }
}

TEST_F(TetrahedralizeJobTest, TheSameFileForAnyNumberOfThreads) {
  TetrahedralizeJob wanted = job(torus());
  const auto bytes = [&](int threads) {
    wanted.threads = threads;
    run(wanted, report_, progress_);
    return test::fileBytes(wanted.output);
  };
  const std::string one = bytes(1);
  EXPECT_EQ(one, bytes(2));
  EXPECT_EQ(one, bytes(5));
}

TEST_F(TetrahedralizeJobTest, RefusesWhatCannotWork) {
  TetrahedralizeJob wanted = job(sheet(4));
  EXPECT_EQ(statusOf(wanted), Status::Invalid);
  wanted = job(box());
  wanted.epsilon = {0.5, RelativeLength::Unit::Voxel};
  EXPECT_EQ(statusOf(wanted), Status::Usage);
  wanted.epsilon = {};
  wanted.output = path("out.stl");
  EXPECT_EQ(statusOf(wanted), Status::Usage);
  wanted.output = path("none/out.msh");
  EXPECT_EQ(statusOf(wanted), Status::Write);
  wanted.output = path("out.msh");
  wanted.maxMemory = 1;
  EXPECT_EQ(statusOf(wanted), Status::Limit);
  wanted.maxMemory = 0;
  wanted.inputs = {path("missing.ply")};
  EXPECT_EQ(statusOf(wanted), Status::Invalid);
  std::ofstream(path("tet.mesh")) << "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n"
                                     "0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
                                     "Tetrahedra\n1\n1 2 3 4 5\nEnd\n";
  wanted.inputs = {path("tet.mesh")};
  EXPECT_EQ(statusOf(wanted), Status::Usage);
}

TEST_F(TetrahedralizeJobTest, CancelledJobsLeaveNothing) {
  const TetrahedralizeJob wanted = job(sphere());
  progress_.cancel();
  EXPECT_EQ(statusOf(wanted), Status::Cancelled);
}

// Plates through one another, in all directions: some minutes, so that it runs where tests are
// scaled up (scripts/weekly.sh).
TEST_F(TetrahedralizeJobTest, PlatesThatCutOneAnotherTooOftenAreRepairedFirst) {
  if (test::scale() < 2)
    GTEST_SKIP();
  Random random(7);
  TriangleMesh plates;
  for (int i = 0; i < 70; ++i) {
    const double a = random.between(0, kPi), b = random.between(0, kPi);
    const Vec3d offset{random.between(-0.3, 0.3), random.between(-0.3, 0.3),
                       random.between(-0.3, 0.3)};
    plates = joined({plates, moved(box({-1, -1, -0.04}, {1, 1, 0.04}), [&](const Vec3d& p) {
                       const Vec3d q{p[0], p[1] * std::cos(a) - p[2] * std::sin(a),
                                     p[1] * std::sin(a) + p[2] * std::cos(a)};
                       return plus(offset, {q[0] * std::cos(b) - q[1] * std::sin(b),
                                            q[0] * std::sin(b) + q[1] * std::cos(b), q[2]});
                     })});
  }
  const TetrahedralizeResult result = run(job(plates), report_, progress_);
  EXPECT_GT(result.repairedFaces.at(0), plates.triangleCount() / 2);
  EXPECT_FALSE(report_.partial);
  EXPECT_GT(result.mesh.made.check.owedPoints, 1000u);
  EXPECT_EQ(result.mesh.made.check.lostPoints, 0u);
}

} // namespace
} // namespace tetvdb
