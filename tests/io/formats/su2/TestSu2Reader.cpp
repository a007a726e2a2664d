// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "io/ResultSamples.h"
#include "tetvdb/io/cells/CellFaces.h"
#include "tetvdb/io/formats/su2/Su2Reader.h"

namespace tetvdb {
namespace {

using namespace test;

TEST(Su2Reader, ZonesAreRegions) {
  const CellMesh mesh = readText(readSu2, su2File());
  EXPECT_EQ(mesh.points.size(), 13U);
  EXPECT_NEAR(cellVolume(mesh), 1 + 1.0 / 3 + 1.0 / 6, 1e-12);
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{1, 1, 2}));
  EXPECT_EQ(mesh.nodes.back(), 12U);
}

TEST(Su2Reader, PlaneMeshesAndSolids) {
  const std::string plane =
      "NDIME= 2\nNELEM= 2\n5\t0 1 2\t0\n9 1 3 4 2 1\nNPOIN= 5\n0 0 0\n1 0 1\n"
      "0 1 2\n2 0 3\n2 1 4\nNMARK= 1\nMARKER_TAG= x\nMARKER_ELEMS= 1\n3 0 1\n";
  Report report;
  Progress progress;
  EXPECT_FALSE(su2HasSolidCells({plane, "a.su2"}, report, progress));
  EXPECT_TRUE(su2HasSolidCells({su2File(), "a.su2"}, report, progress));
  ReadOptions faces;
  faces.faces = true;
  const TriangleMesh mesh =
      trianglesOfFaces(readSu2({plane, "a.su2"}, faces, report, progress), "a.su2");
  EXPECT_EQ(mesh.triangles, (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 4, 1, 4, 2}));
  EXPECT_EQ(mesh.points[4], (Vec3d{2, 1, 0}));
}

TEST(Su2Reader, ErrorsSayWhatIsWrong) {
  const std::string text = su2File();
  const auto error = [&](const std::string& from, const std::string& to) {
    return readingError(readSu2, replaced(text, from, to));
  };
  EXPECT_NE(error("14 4 5 6 7 8 1", "14 4 5 6 7 9 1").find("point 9"), std::string::npos);
  EXPECT_NE(error("14 4 5", "15 4 5").find("type 15"), std::string::npos);
  EXPECT_NE(error("NDIME= 3", "NDIME= 4").find("4 dimensions"), std::string::npos);
  EXPECT_NE(error("NELEM= 2", "NELEM= 2000000").find("2000000"), std::string::npos);
  EXPECT_NE(error("IZONE= 2", "IZONE= 0").find("zone"), std::string::npos);
  EXPECT_NE(readingError(readSu2, "NDIME= 3\n").find("no points"), std::string::npos);
  EXPECT_NE(readingError(readSu2, "NPOIN= 1\n0 0 0\n").find("NDIME"), std::string::npos);
  for (const double share : {0.3, 0.6, 0.9})
    EXPECT_NE(readingError(readSu2, text.substr(0, static_cast<std::size_t>(
                                                       share * static_cast<double>(text.size())))),
              "")
        << share;
}

} // namespace
} // namespace tetvdb
