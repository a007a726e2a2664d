// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "io/ResultSamples.h"
#include "tetvdb/io/cells/CellFaces.h"
#include "tetvdb/io/formats/ideas/UnvReader.h"

namespace tetvdb {
namespace {

using namespace test;

TEST(UnvReader, MeshAndGroups) {
  const CellMesh mesh = readText(readUnv, unvFile());
  EXPECT_EQ(mesh.points.size(), 18U);
  EXPECT_NEAR(cellVolume(mesh), 1 + 8.0 / 6, 1e-12);
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{0, 3, 4, 3}));
  EXPECT_EQ(mesh.regionNames.at(3), "rotor");
  EXPECT_EQ(mesh.regionNames.at(4), "stator");
  ASSERT_EQ(mesh.runs.size(), 4U);
  EXPECT_TRUE(mesh.runs[2].quadratic);
}

TEST(UnvReader, GroupsOfOneNumberAreToldApart) {
  const CellMesh mesh =
      readText(readUnv, replaced(unvFile(), "         4         0         0         0         0",
                                 "         3         0         0         0         0"));
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{0, 1, 2, 1}));
  EXPECT_EQ(mesh.regionNames.at(2), "stator");
}

TEST(UnvReader, GroupsOfFacesAreNoRegions) {
  std::string text = unvFile();
  text.replace(text.find("         8         5         0"), 20, "         8         9");
  text.replace(text.find("         8         7         0"), 20, "         8         1");
  EXPECT_TRUE(readText(readUnv, text).regions.empty());
}

// Of other parabolic elements written_meshes.py.
TEST(UnvReader, MidpointsOfTheTetAreBetweenItsCorners) {
  const CellMesh mesh = readText(readUnv, unvFile());
  const int edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  const std::uint32_t* node = mesh.nodes.data() + 8;
  for (int e = 0; e < 6; ++e)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(mesh.points[node[4 + e]][k],
                (mesh.points[node[edges[e][0]]][k] + mesh.points[node[edges[e][1]]][k]) / 2);
}

TEST(UnvReader, Shells) {
  const std::string text =
      "-1\n2411\n1 1 1 1\n0 0 0\n2 1 1 1\n1 0 0\n3 1 1 1\n1 1 0\n4 1 1 1\n0 1 0\n5 1 1 1\n"
      ".5 0 0\n6 1 1 1\n1 .5 0\n7 1 1 1\n.5 1 0\n8 1 1 1\n0 .5 0\n9 1 1 1\n.5 .5 0\n-1\n"
      "-1\n2412\n1 95 1 1 7 8\n1 5 2 6 3 7 4 8\n2 92 1 1 7 6\n1 5 2 6 3 9\n-1\n";
  Report report;
  Progress progress;
  EXPECT_FALSE(unvHasSolidCells({text, "a.unv"}, report, progress));
  EXPECT_TRUE(unvHasSolidCells({unvFile(), "a.unv"}, report, progress));
  ReadOptions faces;
  faces.faces = true;
  const TriangleMesh mesh =
      trianglesOfFaces(readUnv({text, "a.unv"}, faces, report, progress), "a.unv");
  EXPECT_EQ(mesh.triangles, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 0, 1, 2}));
}

TEST(UnvReader, ErrorsSayWhatIsWrong) {
  const std::string text = unvFile();
  const auto error = [&](const std::string& from, const std::string& to) {
    return readingError(readUnv, replaced(text, from, to));
  };
  EXPECT_NE(
      error("        60        70        80\n", "        60        70        81\n").find("node 81"),
      std::string::npos);
  EXPECT_NE(error("         5       115         1         1         7         8",
                  "         5       115         1         1         7         7")
                .find("has 7 nodes"),
            std::string::npos);
  EXPECT_NE(error("rotor\n", "rotor\n  x").find("x"), std::string::npos);
  EXPECT_NE(readingError(readUnv, "    -1\n  2412\n    -1\n").find("no nodes"), std::string::npos);
  EXPECT_NE(readingError(readUnv, text + "something\n").find("expected '-1'"), std::string::npos);
  for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9})
    EXPECT_NE(readingError(readUnv, text.substr(0, static_cast<std::size_t>(
                                                       share * static_cast<double>(text.size())))),
              "")
        << share;
}

} // namespace
} // namespace tetvdb
