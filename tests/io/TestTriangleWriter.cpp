// SPDX-License-Identifier: Apache-2.0
#include "io/TriangleSamples.h"
#include "tetvdb/io/TriangleWriter.h"

#include <limits>
#include <random>

namespace tetvdb {
namespace {

using namespace test;

/// Points no double of which is short, faces of all kinds, a point that none uses.
TriangleMesh sampleTriangles() {
  TriangleMesh mesh;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1e3, 1e3);
  for (int i = 0; i < 30; ++i)
    mesh.points.push_back({uniform(random), uniform(random) * 1e-6, uniform(random)});
  mesh.points[3] = {-0.0, 1e-30, 1.0 / 3};
  for (std::uint32_t t = 0; t < 40; ++t)
    for (std::uint32_t k = 0; k < 3; ++k)
      mesh.triangles.push_back((7 * t + 5 * k) % 29);
  for (const std::uint32_t corner : {0U, 1U, 2U, 0U, 1U, 2U, 2U, 1U, 0U}) // twice, and turned
    mesh.triangles.push_back(corner);
  mesh.faceCount = mesh.triangleCount();
  return mesh;
}

Reading writeAndRead(const TriangleMesh& mesh, const std::string& ending,
                     std::string* bytes = nullptr) {
  const TemporaryPath path("written" + ending);
  Progress progress;
  writeTriangles(path.str(), mesh, progress);
  if (bytes != nullptr)
    *bytes = readFile(path.str());
  return reading(
      [&](Report& report, Progress&) { return readTriangles(path.str(), report, progress); });
}

TriangleMesh asFloats(TriangleMesh mesh) {
  for (Vec3d& p : mesh.points)
    for (double& x : p) {
      // GCC 12 loses the conversion of the last points where it is a value only.
      const volatile float rounded = static_cast<float>(x);
      x = static_cast<double>(rounded);
    }
  return mesh;
}

TEST(TriangleWriter, ReadsBackTheSame) {
  const TriangleMesh mesh = sampleTriangles();
  for (const char* ending : {".obj", ".ply", ".off", ".OBJ", ".Ply"}) {
    const Reading read = writeAndRead(mesh, ending);
    ASSERT_EQ(read.error, "") << ending;
    EXPECT_EQ(read.mesh.points, mesh.points) << ending;
    EXPECT_EQ(read.mesh.triangles, mesh.triangles) << ending;
    EXPECT_EQ(read.codes(), "");
  }
}

TEST(TriangleWriter, StlIsTheSameSoupInFloats) {
  const TriangleMesh mesh = asFloats(sampleTriangles());
  std::string bytes;
  const Reading read = writeAndRead(sampleTriangles(), ".stl", &bytes);
  ASSERT_EQ(read.mesh.triangleCount(), mesh.triangleCount());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    EXPECT_EQ(read.mesh.points[read.mesh.triangles[i]], mesh.points[mesh.triangles[i]]);
  EXPECT_EQ(bytes.size(), 84 + 50 * mesh.triangleCount());
  EXPECT_EQ(bytes.substr(0, 6), "TetVDB");
}

TEST(TriangleWriter, StlNormalsPointOutward) {
  std::string bytes;
  writeAndRead(cornerTetrahedron(), ".stl", &bytes);
  const auto number = [&](std::size_t at) { return loadNumber<float>(bytes.data() + at, false); };
  EXPECT_EQ(number(84 + 8), -1.0F); // of the face in the plane z = 0
  EXPECT_NEAR(number(84 + 150), 1 / std::sqrt(3.0F), 1e-6);
}

TEST(TriangleWriter, StlWritesWhatFloatsCannotHold) {
  TriangleMesh mesh = cornerTetrahedron();
  mesh.points[1] = {1e300, -1e300, 1e-300};
  const Reading read = writeAndRead(mesh, ".stl");
  EXPECT_EQ(read.mesh.triangleCount(), 4U);
  EXPECT_EQ(read.codes(), "");
}

TEST(TriangleWriter, ThreeMf) {
  TriangleMesh mesh = sampleTriangles();
  for (const char* units : {"micrometre", "millimetre", "centimetre", "inch", "foot", "metre"}) {
    mesh.units = units;
    const Reading read = writeAndRead(mesh, ".3mf");
    ASSERT_EQ(read.error, "");
    EXPECT_EQ(read.mesh.points, mesh.points);
    EXPECT_EQ(read.mesh.triangles, mesh.triangles);
    EXPECT_EQ(read.mesh.units, units);
  }
  mesh.units = "parsec";
  EXPECT_EQ(writeAndRead(mesh, ".3mf").mesh.units, "millimetre");
}

TEST(TriangleWriter, ThreeMfHoldsNoFaceThatNamesAPointTwice) {
  TriangleMesh mesh = cornerTetrahedron();
  mesh.triangles.insert(mesh.triangles.end(), {0, 0, 1, 2, 1, 2});
  EXPECT_EQ(writeAndRead(mesh, ".3mf").mesh.triangles, cornerTetrahedron().triangles);
  mesh.triangles = {0, 0, 1};
  EXPECT_THROW(writeAndRead(mesh, ".3mf"), Error);
}

TEST(TriangleWriter, TheSameMeshGivesTheSameBytes) {
  for (const char* ending : {".stl", ".obj", ".ply", ".off", ".3mf"}) {
    std::string first, second;
    writeAndRead(sampleTriangles(), ending, &first);
    writeAndRead(sampleTriangles(), ending, &second);
    EXPECT_EQ(first, second) << ending;
  }
}

TEST(TriangleWriter, WholeOrAbsent) {
  Progress cancelled;
  cancelled.cancel();
  for (const char* ending : {".stl", ".obj", ".ply", ".off", ".3mf"}) {
    const TemporaryPath path(std::string("cancelled") + ending);
    EXPECT_THROW(writeTriangles(path.str(), sampleTriangles(), cancelled), Error);
    EXPECT_EQ(readFile(path.str()), "");
    Progress progress;
    try {
      writeTriangles(std::string("/nonexistent/folder/a") + ending, sampleTriangles(), progress);
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), Status::Write);
    }
  }
}

TEST(TriangleWriter, KnownExtensions) {
  for (const char* name : {"a.stl", "b/c.OBJ", "a.b.ply", "a.off", "a.3MF"})
    EXPECT_TRUE(writesTriangles(name)) << name;
  for (const char* name : {"a.vtu", "a", "a.stl/b", "stl", ""})
    EXPECT_FALSE(writesTriangles(name)) << name;
  Progress progress;
  try {
    writeTriangles("a.glb", sampleTriangles(), progress);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Usage);
  }
}

} // namespace
} // namespace tetvdb
