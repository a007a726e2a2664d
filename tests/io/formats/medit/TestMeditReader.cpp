// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "tetvdb/io/formats/medit/MeditReader.h"

namespace tetvdb {
namespace {

using namespace test;
using Regions = std::vector<std::int32_t>;

TEST(MeditReader, AllSolidCells) {
  const CellMesh mesh = readText(readMedit, kMedit);
  EXPECT_EQ(mesh.points.size(), 11U);
  EXPECT_EQ(mesh.regions, (Regions{5, 1, 2, 3, 4}));
  EXPECT_EQ(mesh.runs.size(), 5U);
  EXPECT_NEAR(cellVolume(mesh), 1 + 1.0 / 2 + 1.0 / 3 + 1.0 / 6, 1e-15);
}

TEST(MeditReader, CellsMayComeBeforeVertices) {
  const std::string text = kMedit;
  const std::size_t vertices = text.find("Vertices"), corners = text.find("Corners");
  const std::string moved = text.substr(0, vertices) +
                            text.substr(corners, text.find("End") - corners) +
                            text.substr(vertices, corners - vertices) + "End\n";
  EXPECT_NEAR(cellVolume(readText(readMedit, moved)), 2, 1e-15);
  const std::string wrong = moved.substr(0, moved.find("1 2 4 5 4")) + "1 2 4 50 4" +
                            moved.substr(moved.find("1 2 4 5 4") + 9);
  EXPECT_NE(readingError(readMedit, wrong).find("vertex 50 of 11"), std::string::npos);
}

TEST(MeditReader, ErrorsSayWhere) {
  const auto error = [](const std::string& from, const std::string& to) {
    std::string text = kMedit;
    return readingError(readMedit, text.replace(text.find(from), from.size(), to));
  };
  EXPECT_NE(error("Dimension 3", "Dimension 2").find("file:3"), std::string::npos);
  EXPECT_NE(error("1 2 4 5 4", "1 2 0 5 4").find("vertex 0"), std::string::npos);
  EXPECT_NE(error("1 2 4 5 4", "1 2 4 12 4").find("file:34"), std::string::npos);
  EXPECT_NE(error("2 0 1 0", "2 inf 1 0").find("finite"), std::string::npos);
  EXPECT_NE(error("Vertices\n11", "Vertices\n99999999999").find("file holds"), std::string::npos);
  EXPECT_NE(error("Vertices\n11", "Vertices\n10").find("file:16"), std::string::npos);
  EXPECT_NE(error("Vertices\n11", "Corners\n11").find("Vertices"), std::string::npos);
}

TEST(MeditReader, BinaryVersionsInBothByteOrders) {
  for (const int version : {1, 2, 3, 4})
    for (const bool swap : {false, true}) {
      const CellMesh mesh = readText(readMeditBinary, meditBinary(version, swap));
      EXPECT_EQ(mesh.points.size(), 5U);
      EXPECT_EQ(mesh.regions, (Regions{9, 3, 4})) << version << swap;
      EXPECT_NEAR(cellVolume(mesh), 0.5, 1e-15);
    }
}

TEST(MeditReader, BinaryErrorsSayWhere) {
  std::string text = meditBinary(2, false);
  EXPECT_NE(readingError(readMeditBinary, text.substr(0, 100)).find("file at byte"),
            std::string::npos);
  text[4] = 9;
  EXPECT_NE(readingError(readMeditBinary, text).find("version 9"), std::string::npos);
  text = meditBinary(2, false);
  text[12] = 1; // the place of the second keyword
  EXPECT_NE(readingError(readMeditBinary, text).find("lies before it"), std::string::npos);
}

TEST(MeditReader, DemoMesh) {
  const CellMesh mesh = readText(readMedit, readFile(dataFile("quadcopter_frame.mesh")));
  EXPECT_EQ(mesh.points.size(), 7121U);
  EXPECT_EQ(mesh.cellCount(), 32826U);
  EXPECT_NEAR(cellVolume(mesh), 0.000298017083, 1e-12);
}

} // namespace
} // namespace tetvdb
