// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "io/ResultSamples.h"
#include "tetvdb/io/cells/CellFaces.h"
#include "tetvdb/io/formats/calculix/FrdReader.h"

#include <cmath>

namespace tetvdb {
namespace {

using namespace test;

std::vector<double> timesOf(const std::string& bytes) {
  Report report;
  Progress progress;
  return frdTimes({bytes, "file"}, report, progress);
}

const Attribute& arrayOf(const CellMesh& mesh, const std::string& name) {
  for (const Attribute& array : mesh.attributes)
    if (array.name == name)
      return array;
  throw std::runtime_error("no array " + name);
}

class FrdForms : public testing::TestWithParam<int> {};

TEST_P(FrdForms, MeshStepsAndArrays) {
  const std::string bytes = frdFile(GetParam());
  EXPECT_EQ(timesOf(bytes), (std::vector<double>{0.5, 1}));
  Report report;
  const CellMesh mesh = readText(readFrd, bytes, &report);
  EXPECT_TRUE(report.warnings.empty());
  ASSERT_EQ(mesh.points.size(), 9U);
  EXPECT_EQ(mesh.points[8], (Vec3d{0.5, 0.5, 2}));
  EXPECT_NEAR(cellVolume(mesh), 1 + 1.0 / 6, 1e-6);
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{1, 2}));
  EXPECT_EQ(mesh.regionNames.at(2), "STEEL");
  const Attribute& moved = arrayOf(mesh, "DISP");
  EXPECT_EQ(moved.components, 3U); // that which the reader would compute is not there
  for (std::size_t i = 0; i < 9; ++i)
    for (std::uint32_t c = 0; c < 3; ++c)
      EXPECT_FLOAT_EQ(static_cast<float>(moved.number(i, c)),
                      2 * static_cast<float>(i) + 0.25F * static_cast<float>(c));
  const Attribute& stress = arrayOf(mesh, "STRESS"); // more components than a line has
  EXPECT_EQ(stress.components, 7U);
  EXPECT_TRUE(std::isnan(stress.number(0, 0))); // it begins with the second node
  EXPECT_FLOAT_EQ(static_cast<float>(stress.number(8, 6)), -8.5F);

  ReadOptions first;
  first.timeStep = 0;
  EXPECT_FLOAT_EQ(
      static_cast<float>(arrayOf(readText(readFrd, bytes, nullptr, first), "DISP").number(1, 0)),
      1.0F);
  first.timeStep = 2;
  EXPECT_THROW(readText(readFrd, bytes, nullptr, first), Error);
}

TEST(FrdReader, MaterialsThatAreNames) {
  std::string bytes = frdFile(1);
  for (const auto& [number, name] :
       {std::pair{"    0    1", "    0EL   "}, {"    0    2", "    0AIR  "}}) {
    const std::size_t at = bytes.find(std::string(number) + "\n -2");
    ASSERT_NE(at, bytes.npos);
    bytes.replace(at, std::string(number).size(), name);
  }
  const CellMesh mesh = readText(readFrd, bytes);
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{1, 2}));
  EXPECT_EQ(mesh.regionNames.at(1), "EL");
  EXPECT_EQ(mesh.regionNames.at(2), "AIR");
}

// Short and long text, floats, doubles.
INSTANTIATE_TEST_SUITE_P(All, FrdForms, testing::Values(0, 1, 2, 3));

TEST(FrdReader, QuadraticElementsAreInOurOrder) {
  const CellMesh mesh = readText(readFrd, frdQuadratic());
  ASSERT_EQ(mesh.runs.size(), 1U);
  EXPECT_EQ(mesh.runs[0].nodesPerCell, 20U);
  // Every middle lies between the corners of its edge.
  constexpr int edges[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  for (std::size_t e = 0; e < 12; ++e)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d &a = mesh.points[mesh.nodes[std::size_t(edges[e][0])]],
                  &b = mesh.points[mesh.nodes[std::size_t(edges[e][1])]];
      EXPECT_DOUBLE_EQ(mesh.points[mesh.nodes[8 + e]][k], (a[k] + b[k]) / 2) << e;
    }
}

TEST(FrdReader, ShellsAreTriangles) {
  const std::string bytes = frdFile(1);
  Report report;
  Progress progress;
  ReadOptions faces;
  faces.faces = true;
  EXPECT_TRUE(hasSolidCells(readFrd({bytes, "file"}, faces, report, progress)));
  const std::string shells = frdShells();
  const TriangleMesh mesh =
      trianglesOfFaces(readFrd({shells, "file"}, faces, report, progress), "file");
  EXPECT_EQ(mesh.triangles, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 1, 2, 5}));
  EXPECT_EQ(mesh.faceCount, 2U);
}

// CalculiX does not count the nodes that it adds to shells.
TEST(FrdReader, CountsOfTextMayBeWrong) {
  std::string bytes = frdFile(1);
  bytes.replace(bytes.find("           9"), 12, "           4");
  Report report;
  EXPECT_EQ(readText(readFrd, bytes, &report).points.size(), 9U);
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_EQ(report.warnings[0].code, "wrong-count");
}

TEST(FrdReader, ValuesOfOtherNodesArePassedOver) {
  std::string bytes = frdFile(1);
  const std::size_t at = bytes.rfind(" -1         9"); // of the last array
  bytes.replace(at, 13, " -1        99");
  Report report;
  EXPECT_TRUE(std::isnan(arrayOf(readText(readFrd, bytes, &report), "STRESS").number(8, 0)));
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_EQ(report.warnings[0].code, "unknown-ids");
}

TEST(FrdReader, ErrorsNameTheLine) {
  const std::string bytes = frdFile(1);
  const auto broken = [&](const std::string& from, const std::string& to) {
    std::string damaged = bytes;
    const std::size_t at = damaged.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    damaged.replace(at, from.size(), to);
    return readingError(readFrd, damaged);
  };
  EXPECT_NE(broken(" -2         1         2", " -2         1        77").find("node 77"),
            std::string::npos);
  EXPECT_NE(broken(" -1         1    1", " -1         1   13").find("type 13"), std::string::npos);
  EXPECT_NE(readingError(readFrd, bytes.substr(0, bytes.size() / 2)), "");
  EXPECT_NE(readingError(readFrd, "    1C\n    7X\n").find("file:2"), std::string::npos);
}

} // namespace
} // namespace tetvdb
