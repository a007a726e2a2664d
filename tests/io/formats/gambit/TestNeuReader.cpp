// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "io/ResultSamples.h"
#include "tetvdb/io/formats/gambit/NeuReader.h"

namespace tetvdb {
namespace {

using namespace test;

TEST(NeuReader, MeshAndGroups) {
  const CellMesh mesh = readText(readNeu, neuFile(false));
  EXPECT_EQ(mesh.points.size(), 9U);
  EXPECT_NEAR(cellVolume(mesh), 1 + 1.0 / 3, 1e-12);
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{1, 7, 0}));
  EXPECT_EQ(mesh.regionNames.at(1), "water");
  EXPECT_EQ(mesh.regionNames.at(7), "roof");
}

TEST(NeuReader, BasesMayGoAlongRows) {
  EXPECT_EQ(readText(readNeu, neuFile(true)).nodes, readText(readNeu, neuFile(false)).nodes);
}

TEST(NeuReader, QuadraticElementsAreSkipped) {
  const CellMesh mesh = readText(readNeu, replaced(neuFile(false), "       5  7  5        5",
                                                   "       5  6 10        1  2 3 4 5 6"));
  EXPECT_EQ(mesh.runs[1].type, CellType::OtherSolid);
  EXPECT_EQ(mesh.runs[1].fileType, "quadratic tetrahedron");
}

TEST(NeuReader, ErrorsNameTheLine) {
  const std::string text = neuFile(false);
  EXPECT_NE(readingError(readNeu, replaced(text, "8       9", "8      10")).find("node 10"),
            std::string::npos);
  EXPECT_NE(
      readingError(readNeu, replaced(text, "       5  7  5", "       5  8  5")).find("type 8"),
      std::string::npos);
  EXPECT_NE(readingError(readNeu, replaced(text, "       0\n       5", "       0\n       9"))
                .find("element 9"),
            std::string::npos);
  EXPECT_NE(readingError(readNeu, replaced(text, "         9         3", "       999         3"))
                .find("999"),
            std::string::npos);
  for (const double share : {0.1, 0.3, 0.5, 0.7})
    EXPECT_NE(readingError(readNeu, text.substr(0, static_cast<std::size_t>(
                                                       share * static_cast<double>(text.size())))),
              "")
        << share;
}

} // namespace
} // namespace tetvdb
