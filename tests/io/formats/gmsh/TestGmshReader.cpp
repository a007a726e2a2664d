// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "tetvdb/io/formats/gmsh/GmshReader.h"

namespace tetvdb {
namespace {

using namespace test;
using Regions = std::vector<std::int32_t>;

void expectTwoTets(const CellMesh& mesh) {
  const TetMesh tets = splitAll(mesh);
  EXPECT_EQ(tets.points.size(), 5U);
  EXPECT_EQ(tets.tets, (std::vector<std::uint32_t>{0, 1, 2, 3, 1, 2, 3, 4}));
  EXPECT_NEAR(tetVolume(tets), 0.5, 1e-15);
}

TEST(GmshReader, EveryTextVersion) {
  for (const char* text : {kGmsh1, kGmsh2, kGmsh40, kGmsh41}) {
    const CellMesh mesh = readText(readGmsh, text);
    expectTwoTets(mesh);
    EXPECT_EQ(mesh.regions.back(), 4) << text;
    EXPECT_EQ(mesh.regions[1], 3);
    ASSERT_EQ(mesh.runs.size(), 2U);
    EXPECT_EQ(mesh.runs[0].fileType, "triangle");
    EXPECT_EQ(mesh.runs[0].nodesPerCell, 0U);
  }
}

TEST(GmshReader, EveryBinaryVersionInBothByteOrders) {
  for (const bool swap : {false, true}) {
    expectTwoTets(readText(readGmsh, gmshBinary2(swap)));
    expectTwoTets(readText(readGmsh, gmshBinary40(swap)));
    expectTwoTets(readText(readGmsh, gmshBinary41(swap)));
    EXPECT_EQ(readText(readGmsh, gmshBinary41(swap)).regions, (Regions{3, 3}));
    EXPECT_EQ(readText(readGmsh, gmshBinary2(swap)).regions, (Regions{7, 3, 4}));
  }
}

TEST(GmshReader, WindowsLineEnds) {
  std::string text;
  for (const char c : std::string(kGmsh2)) {
    if (c == '\n')
      text += '\r';
    text += c;
  }
  const CellMesh mesh = readText(readGmsh, text);
  expectTwoTets(mesh);
  EXPECT_EQ(mesh.regionNames.at(4), "bone");
  EXPECT_EQ(mesh.attributes.at(0).name, "temperature");
}

TEST(GmshReader, PhysicalNamesOfVolumesOnly) {
  const CellMesh mesh = readText(readGmsh, kGmsh2);
  EXPECT_EQ(mesh.regionNames, (std::map<std::int32_t, std::string>{{3, "soft part"}, {4, "bone"}}));
}

TEST(GmshReader, PhysicalNamesOfVersion2HaveNoDimension) {
  std::string text = replaced(kGmsh2, "2.2 0 8", "2 0 8");
  text = replaced(text, "3\n2 7 \"skin\"\n3 3 \"soft", "2\n3 \"soft");
  text = replaced(text, "3 4 \"bone\"", "4 \"bone\"");
  const CellMesh mesh = readText(readGmsh, text);
  expectTwoTets(mesh);
  EXPECT_EQ(mesh.regionNames, (std::map<std::int32_t, std::string>{{3, "soft part"}, {4, "bone"}}));
}

TEST(GmshReader, GeometricalEntitiesWhereNoPhysicalGroupIs) {
  std::string text = replaced(kGmsh2, "5 4 2 3 1", "5 4 2 0 11");
  text = replaced(text, "9 4 4 4 2", "9 4 4 0 12");
  const CellMesh mesh = readText(readGmsh, text);
  EXPECT_EQ(mesh.regions, (Regions{1, 11, 12}));
  EXPECT_TRUE(mesh.regionNames.empty());
}

TEST(GmshReader, PartitionedEntitiesKeepTheirParents) {
  const std::string text =
      replaced(kGmsh41, "$Nodes",
               "$PartitionedEntities\n2 0\n0 0 0 2\n1 3 50 1 1 0 0 0 1 1 1 0 0\n"
               "2 3 51 1 2 0 0 0 1 1 1 1 60 0\n$EndPartitionedEntities\n$Nodes");
  EXPECT_EQ(readText(readGmsh, text).regions, (Regions{0, 0, 60}));
}

TEST(GmshReader, DataOfSomeElementsAreNanElsewhere) {
  const CellMesh mesh = readText(readGmsh, kGmsh2);
  ASSERT_EQ(mesh.attributes.size(), 2U);
  EXPECT_EQ(mesh.attributes[0].on, Attribute::On::Points);
  EXPECT_EQ(mesh.attributes[0].number(4), 5);
  const Attribute& stress = mesh.attributes[1];
  EXPECT_EQ(stress.name, "stress");
  EXPECT_EQ(stress.components, 3U);
  EXPECT_EQ(stress.number(2, 1), 2.5);
  EXPECT_TRUE(std::isnan(stress.number(0, 0)));
  EXPECT_TRUE(std::isnan(stress.number(1, 2)));
}

TEST(GmshReader, LastTimeStepCounts) {
  std::string text = kGmsh2;
  for (const char* step : {"7", "3"}) // out of order
    text += std::string("$NodeData\n1\n\"temperature\"\n0\n3\n") + step + "\n1\n1\n10 " + step +
            "\n$EndNodeData\n";
  const CellMesh mesh = readText(readGmsh, text);
  ASSERT_EQ(mesh.attributes.size(), 2U);
  EXPECT_EQ(mesh.attributes[0].number(0), 7);
  EXPECT_TRUE(std::isnan(mesh.attributes[0].number(1)));
}

TEST(GmshReader, AttributesCanBeLeftOut) {
  ReadOptions options;
  options.attributes = false;
  EXPECT_TRUE(readText(readGmsh, kGmsh2, nullptr, options).attributes.empty());
}

TEST(GmshReader, QuadraticCellsKeepTheirNodes) {
  std::string cell = "5 11 2 3 1 10 20 30 40 77 77 77 77 77 77";
  const CellMesh mesh = readText(readGmsh, replaced(kGmsh2, "5 4 2 3 1 10 20 30 40", cell));
  ASSERT_EQ(mesh.runs.size(), 3U);
  EXPECT_TRUE(mesh.runs[1].quadratic);
  EXPECT_EQ(mesh.runs[1].nodesPerCell, 10U);
  EXPECT_FALSE(mesh.runs[2].quadratic);
  Report report;
  Progress progress;
  const TetMesh tets = splitCells(CellMesh(mesh), {}, report, progress);
  EXPECT_EQ(tets.tetCount(), 2U); // beside linear cells by the corners
  EXPECT_EQ(report.warnings.at(0).code, "quadratic-cells");
}

TEST(GmshReader, WildNumbersOfNodes) {
  std::string text = kGmsh2;
  for (int i = 0; i < 4; ++i) // one in the nodes, one in the element, two in the data
    if (const std::size_t at = text.find("\n77 "); at != text.npos)
      text.replace(at, 4, "\n99000000000 ");
  text = replaced(text, " 77\n", " 99000000000\n");
  expectTwoTets(readText(readGmsh, text));
}

TEST(GmshReader, RepeatedNodeNumbersAreWarnedOf) {
  Report report;
  readText(readGmsh, replaced(kGmsh2, "5\n10 0 0 0", "6\n10 5 5 5\n10 0 0 0"), &report);
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_EQ(report.warnings[0].code, "duplicate-ids");
}

TEST(GmshReader, ErrorsSayWhere) {
  const auto error = [](const std::string& from, const std::string& to) {
    return readingError(readGmsh, replaced(kGmsh2, from, to));
  };
  EXPECT_NE(error("20 30 40 77", "20 30 40 78").find("file:22: element 3 of the file uses node 78"),
            std::string::npos);
  EXPECT_NE(error("0 0 1\n", "0 0 nan\n").find("file:15"), std::string::npos);
  EXPECT_NE(error("0 0 1\n", "0 0 1e999\n").find("finite"), std::string::npos);
  EXPECT_NE(error("5\n10", "500000\n10").find("more than the file holds"), std::string::npos);
  EXPECT_NE(error("5\n10", "-5\n10").find("negative"), std::string::npos);
  EXPECT_NE(error("5\n10", "6\n10").find("'$EndNodes'"), std::string::npos);
  EXPECT_NE(error("5\n10", "4\n10").find("$EndNodes"), std::string::npos);
  EXPECT_NE(error("5 4 2", "5 141 2").find("element type 141"), std::string::npos);
  EXPECT_NE(error("2.2 0 8", "5.5 0 8").find("version"), std::string::npos);
  EXPECT_NE(error("$EndComments", "$EndComment").find("$Comments has no end"), std::string::npos);
  EXPECT_NE(readingError(readGmsh, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n").find("$Nodes"),
            std::string::npos);
}

TEST(GmshReader, MalformedFilesOfOthers) {
  EXPECT_NE(readingError(readGmsh, readFile(dataFile("malformed_missing_node.msh"))), "");
  EXPECT_NE(readingError(readGmsh, readFile(dataFile("malformed_missing_header.msh"))), "");
}

TEST(GmshReader, RealFiles) {
  // By the corners alone it is 0.505397059, the ball 0.523598776.
  const double sphere =
      cellVolume(readText(readGmsh, readFile(dataFile("quadratic_sphere_tet.msh"))));
  EXPECT_GT(sphere, 0.515);
  EXPECT_LT(sphere, 0.523598776);
  const CellMesh table = readText(readGmsh, readFile(dataFile("table.msh")));
  EXPECT_EQ(table.attributes.at(0).name, "color");
  EXPECT_NEAR(cellVolume(table), 4.34480703, 1e-8);
  const CellMesh hybrid = readText(readGmsh, readFile(dataFile("hybrid_tetwedge.msh")));
  EXPECT_EQ(hybrid.runs.back().type, CellType::Wedge);
  EXPECT_EQ(splitAll(hybrid).tetCount(), 99U + 3 * 99U);
}

} // namespace
} // namespace tetvdb
