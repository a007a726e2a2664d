// SPDX-License-Identifier: Apache-2.0
#include "io/MeshSamples.h"
#include "io/TriangleSamples.h"
#include "tetvdb/io/formats/abaqus/AbaqusReader.h"

#include <string>
#include <vector>

namespace tetvdb {
namespace {

using namespace test;
using Regions = std::vector<std::int32_t>;

std::string regionName(const CellMesh& mesh, std::size_t cell) {
  const auto name = mesh.regionNames.find(mesh.regions.at(cell));
  return name == mesh.regionNames.end() ? "" : name->second;
}

TEST(AbaqusReader, NodesElementsAndSets) {
  const CellMesh mesh = readText(readAbaqus, kAbaqus);
  EXPECT_EQ(mesh.points.size(), 5U);
  EXPECT_NEAR(cellVolume(mesh), 0.5, 1e-15);
  ASSERT_EQ(mesh.runs.size(), 2U);
  EXPECT_EQ(mesh.runs[1].fileType, "C3D4");
  EXPECT_EQ(regionName(mesh, 0), "skin");
  EXPECT_EQ(regionName(mesh, 1), "\"Soft Part\"");
  EXPECT_EQ(regionName(mesh, 2), "bone");
}

TEST(AbaqusReader, SolidSectionsDecideWhereTheyAre) {
  const std::string text = replaced(kAbaqus, "*Material",
                                    "*Elset, elset=all\nbone, EALL\n"
                                    "*Solid Section, elset=ALL, material=m\n"
                                    "1.,\n*Material");
  const CellMesh mesh = readText(readAbaqus, text);
  EXPECT_EQ(mesh.regions, (Regions{0, 1, 1}));
  EXPECT_EQ(mesh.regionNames.at(1), "all");
}

TEST(AbaqusReader, KindsOfElements) {
  const std::string nodes = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n"
                            "8,0,1,1\n";
  const auto volume = [&](const std::string& element) {
    return cellVolume(readText(readAbaqus, nodes + element));
  };
  EXPECT_NEAR(volume("*ELEMENT,TYPE=C3D8R\n1,1,2,3,4,5,6,7,8\n"), 1, 1e-15);
  EXPECT_NEAR(volume("*ELEMENT,TYPE=C3D6\n1,1,2,3,5,6,7\n"), 0.5, 1e-15);
  EXPECT_NEAR(volume("*ELEMENT,TYPE=COH3D8\n1,1,2,3,4,5,6,7,8\n"), 1, 1e-15);
  EXPECT_NEAR(volume("*ELEMENT,TYPE=C3D5\n1,1,2,3,4,5\n"), 1.0 / 3, 1e-15);
  // Of more nodes TestNodeOrder.cpp.
  EXPECT_NEAR(volume("*NODE\n9,.5,0,0\n10,.5,.5,0\n11,0,.5,0\n12,0,0,.5\n13,.5,0,.5\n14,0,.5,.5\n"
                     "*ELEMENT,TYPE=C3D10M\n1,1,2,4,5,9,10,11,12,13,14\n"),
              1.0 / 6, 1e-15);
  EXPECT_NEAR(volume("*ELEMENT,TYPE=R3D4\n1,1,2,3,4\n*ELEMENT,TYPE=C3D4\n2,1,2,4,5\n"), 1.0 / 6,
              1e-15);
}

const char* const kAssembly = R"(*Part, name=Block
*Node
1, 0., 0., 0.
2, 1., 0., 0.
3, 0., 1., 0.
4, 0., 0., 1.
*Element, type=C3D4
1, 1, 2, 3, 4
*Elset, elset=mat
1,
*Solid Section, elset=mat, material=steel
,
*End Part
*Assembly, name=Assembly
*Instance, name=Block-1, part=Block
*End Instance
*Instance, name=Block-2, part=Block
10., 0., 0.
10., 0., 0., 10., 0., 1., 90.
*End Instance
*End Assembly
)";

TEST(AbaqusReader, InstancesArePlaced) {
  const CellMesh mesh = readText(readAbaqus, kAssembly);
  ASSERT_EQ(mesh.points.size(), 8U);
  EXPECT_NEAR(cellVolume(mesh), 1.0 / 3, 1e-15);
  EXPECT_NEAR(mesh.points[5][0], 10, 1e-14); // (1, 0, 0) moved by 10, then turned to y
  EXPECT_NEAR(mesh.points[5][1], 1, 1e-14);
  EXPECT_EQ(mesh.nodes[4], 4U);
  EXPECT_EQ(mesh.regions, (Regions{1, 1}));
}

// As CalculiX's decks name what cgx writes: lines of other files, between keywords, as the data of
// a keyword, or amid data lines.
TEST(AbaqusReader, IncludedFiles) {
  const TemporaryPath deck("deck.inp"), points("points.inp"), cells("all cells.msh");
  const auto read = [&] {
    Report report;
    Progress progress;
    const MappedFile file(deck.str());
    EXPECT_TRUE(abaqusHasSolidCells(file.source(), report, progress));
    return readAbaqus(file.source(), {}, report, progress);
  };
  points.write("** of a cube\n2,1,0,0\n3,0,1,0\n4,0,0,1"); // the last line does not end
  cells.write("*ELEMENT, TYPE=C3D4, ELSET=Upper\n1,1,2,3,4\n");
  deck.write("*HEADING\n*NODE\n1,0,0,0\n*include,\n input=" + points.name() +
             "\n5,0,0,-1\n*INCLUDE, INPUT=\"" + cells.name() +
             "\"\n2,1,3,2,5\n*ELSET, ELSET=Lower\n2\n*STEP\n");
  CellMesh mesh = read();
  EXPECT_EQ(mesh.points.size(), 5U);
  EXPECT_NEAR(cellVolume(mesh), 2.0 / 6, 1e-15);
  EXPECT_EQ(regionName(mesh, 0), "Upper");
  EXPECT_EQ(regionName(mesh, 1), "Lower");

  deck.write("*NODE, INPUT=" + points.name() + "\n1,0,0,0\n*INCLUDE,INPUT=" + cells.name() + "\n");
  mesh = read();
  EXPECT_EQ(mesh.points.size(), 4U);
  EXPECT_NEAR(cellVolume(mesh), 1.0 / 6, 1e-15);

  points.write("2,1,0,0\n3,0,x,0\n");
  try {
    read();
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(points.name() + ":2"), std::string::npos)
        << error.what();
  }
  points.write("*INCLUDE, INPUT=" + points.name() + "\n"); // itself
  EXPECT_THROW(read(), Error);
}

TEST(AbaqusReader, WhatIsNotThereIsNamed) {
  EXPECT_NE(readingError(readAbaqus, "*INCLUDE, INPUT=mesh.inp\n").find("'mesh.inp'"),
            std::string::npos);
  EXPECT_NE(readingError(readAbaqus, "*NODE, INPUT=nodes.inp\n").find("'nodes.inp'"),
            std::string::npos);
  EXPECT_NE(readingError(readAbaqus, "*NODE, INPUT=../nodes.inp\n").find("outside its folder"),
            std::string::npos);
  EXPECT_NE(readingError(readAbaqus, "*NODE\n1,0,0,0\n*INCLUDE\n").find("file:3"),
            std::string::npos);
  EXPECT_NE(readingError(readAbaqus, "*NODE\n1,0,0,0\n*NGEN\n1,5,1\n").find("*NGEN"),
            std::string::npos);
  EXPECT_NE(readingError(readAbaqus, "*NODE, SYSTEM=C\n1,0,0,0\n").find("cylindrical"),
            std::string::npos);
}

TEST(AbaqusReader, ErrorsSayWhere) {
  const auto error = [](const std::string& from, const std::string& to) {
    return readingError(readAbaqus, replaced(kAbaqus, from, to));
  };
  EXPECT_NE(error("5, 10, 20, 30, 40", "5, 10, 20, 31, 40").find("node 31"), std::string::npos);
  EXPECT_NE(error("1.D0", "1.X0").find("file:7: expected a finite number"), std::string::npos);
  EXPECT_NE(error("1.D0", "nan").find("file:7"), std::string::npos);
  EXPECT_NE(error("40, 77", "").find("file:14"), std::string::npos);
  EXPECT_NE(error("5, 10, 20, 30, 40", "5, 10, 20, 30, 40, 40").find("more nodes"),
            std::string::npos);
  EXPECT_NE(error("8, 10, 1", "8, 10, 0").find("step"), std::string::npos);
}

TEST(AbaqusReader, SetsInCircles) {
  const std::string text = std::string(kAbaqus) + "*ELSET,ELSET=A\nB\n*ELSET,ELSET=B\nA,5\n";
  EXPECT_EQ(regionName(readText(readAbaqus, text), 1), "B");
}

TEST(AbaqusReader, RealFile) {
  const CellMesh mesh = readText(readAbaqus, readFile(dataFile("abaqus_tet.inp")));
  EXPECT_NEAR(cellVolume(mesh), 0.666666702, 1e-9);
  EXPECT_EQ(regionName(mesh, 0), "MAT1");
  EXPECT_EQ(regionName(mesh, 13), "MAT2");
}

} // namespace
} // namespace tetvdb
