// SPDX-License-Identifier: Apache-2.0
#include "io/VtkTestMesh.h"
#include "tetvdb/io/formats/vtk/VtkReader.h"

namespace tetvdb::test {
namespace {

const char* const kHead = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\n";
const char* const kTet = "POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n"
                         "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";

} // namespace

TEST(VtkReader, EveryVersionAndModeIsTheSameMesh) {
  for (const std::string& name : dataFiles("mixed_", ".vtk")) {
    SCOPED_TRACE(name);
    Report report;
    expectMixedMesh(read(readVtk, fileBytes(dataPath(name)), report, name));
    EXPECT_TRUE(report.warnings.empty());
  }
}

TEST(VtkReader, PolyhedraInBothVersions) {
  for (const std::string& name : dataFiles("polyhedra", ".vtk")) {
    SCOPED_TRACE(name);
    const CellMesh mesh = read(readVtk, fileBytes(dataPath(name)));
    ASSERT_EQ(mesh.runs.size(), 3u);
    EXPECT_EQ(mesh.runs[0].type, CellType::Polyhedron);
    EXPECT_EQ(mesh.runs[0].nodesPerCell, 17u);
    EXPECT_EQ(mesh.runs[2].nodesPerCell, 31u);
  }
}

TEST(VtkReader, MixedTypesOfVersion1) {
  const CellMesh mesh = read(readVtk, fileBytes(dataPath("vtk-data__qualityEx.vtk")));
  EXPECT_EQ(mesh.points.size(), 16u);
  EXPECT_EQ(mesh.cellCount(), 12u);
  ASSERT_EQ(mesh.runs.size(), 4u);
  EXPECT_EQ(mesh.runs[0].count, 3u);
  EXPECT_EQ(mesh.runs[2].type, CellType::Hexahedron);
  EXPECT_EQ(mesh.nodes.size(), 3u * 4 + 2 * 8);
}

TEST(VtkReader, QuadraticCells) {
  const CellMesh mesh = read(readVtk, fileBytes(dataPath("mfem__fichera-mixed-p2.vtk")));
  ASSERT_EQ(mesh.runs.size(), 3u);
  for (const CellRun& run : mesh.runs)
    EXPECT_TRUE(run.quadratic);
  EXPECT_EQ(mesh.runs[0].fileType, "tetra10");
  EXPECT_EQ(mesh.nodes.size(), 5u * 10 + 3 * 27 + 6 * 18);
  EXPECT_EQ(mesh.attributes.at(0).name, "material");
}

TEST(VtkReader, QuadraticCellsUnderTheLinearTypeAreReadByTheirCorners) {
  std::string text = std::string(kHead) + "POINTS 20 float\n";
  for (int i = 0; i < 20; ++i)
    text += std::to_string(i) + " 0 0\n";
  text += "CELLS 2 42\n";
  for (const int first : {0, 10}) {
    text += "20";
    for (int i = 0; i < 20; ++i)
      text += " " + std::to_string((first + i) % 20);
    text += "\n";
  }
  const CellMesh mesh = read(readVtk, text + "CELL_TYPES 2\n12 12\n");
  ASSERT_EQ(mesh.runs.size(), 1u);
  EXPECT_TRUE(mesh.runs[0].quadratic);
  EXPECT_EQ(mesh.nodes,
            (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7, 10, 11, 12, 13, 14, 15, 16, 17}));
  EXPECT_FALSE(errorOf(readVtk, text + "CELL_TYPES 2\n12 13\n").empty()) << "no wedge has 20";
}

TEST(VtkReader, BulletsFileWithoutSpaceSizeAndTypes) {
  Report report;
  const CellMesh mesh = read(readVtk, fileBytes(dataPath("bullet3__beam_mesh.vtk")), report);
  EXPECT_EQ(mesh.points.size(), 28u);
  EXPECT_EQ(mesh.nodes.size(), 4u * 48);
  EXPECT_EQ(report.warnings.size(), 2u);
}

TEST(VtkReader, EveryKindOfArray) {
  const std::string text = std::string(kHead) + "FIELD FieldData 2\nTimeValue 1 1 double\n0.5\n" +
                           "note 1 2 string\nPOINTS are here\nCELLS too\n" + kTet +
                           "METADATA\nINFORMATION 1\nNAME x LOCATION y\nDATA 1 2\n\n" +
                           "POINT_DATA 4\n"
                           "SCALARS a%20b float 2\nLOOKUP_TABLE mine\n1 2 3 4 5 6 7 8\n"
                           "LOOKUP_TABLE mine 2\n0 0 0 1 1 1 1 1\n"
                           "scalars \"with space\" int\n1 2 3 4\n"
                           "VECTORS v double\n1 2 3 4 5 6 7 8 9 10 11 12\n"
                           "NORMALS n float\n1 0 0 1 0 0 1 0 0 1 0 0\n"
                           "TEXTURE_COORDINATES uv 2 float\n1 2 3 4 5 6 7 8\n"
                           "COLOR_SCALARS rgb 3\n0 0 0 .5 .5 .5 1 1 1 0 0 0\n"
                           "GLOBAL_IDS gid vtkIdType\n10 11 12 13\n"
                           "FIELD more 2\nf 1 4 unsigned_char\n1 2 3 255\n"
                           "METADATA\nCOMPONENT_NAMES\nx\n\n\ng 1 4 vtktypeint64\n1 2 3 4\n"
                           "CELL_DATA 1\n"
                           "TENSORS t float\n1 2 3\n4 5 6\n7 8 9\n"
                           "TENSORS6 s float\n1 2 3 4 5 6\n";
  Report report;
  const CellMesh mesh = read(readVtk, text, report);
  EXPECT_TRUE(report.warnings.empty());
  const auto point = [&](const char* name) { return find(mesh, name, Attribute::On::Points); };
  ASSERT_EQ(mesh.attributes.size(), 11u);
  ASSERT_TRUE(point("a b") && point("with space") && point("v") && point("uv") && point("f"));
  EXPECT_EQ(point("a b")->number(3, 1), 8);
  EXPECT_TRUE(point("with space")->isInteger());
  EXPECT_EQ(point("v")->number(3, 2), 12);
  EXPECT_EQ(point("uv")->components, 2u);
  EXPECT_EQ(point("rgb")->number(1, 0), 0.5);
  EXPECT_EQ(point("gid")->number(3), 13);
  EXPECT_EQ(point("f")->number(3), 255);
  EXPECT_EQ(point("g")->values.index(), 3u);
  EXPECT_EQ(find(mesh, "t", Attribute::On::Cells)->components, 9u);
  EXPECT_EQ(find(mesh, "s", Attribute::On::Cells)->number(0, 5), 6);
}

TEST(VtkReader, WindowsLineEndsAndLowerCase) {
  std::string text = "# vtk datafile version 2.0\r\nx\r\nascii\r\ndataset unstructured_grid\r\n";
  for (const char* c = kTet; *c != 0; ++c)
    text += *c == '\n' ? std::string("\r\n")
                       : std::string(1, *c >= 'A' && *c <= 'Z' ? static_cast<char>(*c + 32) : *c);
  EXPECT_EQ(read(readVtk, text).nodes, (std::vector<std::uint32_t>{0, 1, 2, 3}));
}

TEST(VtkReader, MeshesThatDoNotFitNameTheirLine) {
  const auto with = [](const std::string& what, const std::string& other) {
    std::string text = std::string(kHead) + kTet;
    return errorOf(readVtk, text.replace(text.find(what), what.size(), other));
  };
  EXPECT_TRUE(contains(with("4 0 1 2 3", "4 0 1 2 4"), "point 4, but there are 4 points"));
  EXPECT_TRUE(contains(with("4 0 1 2 3", "5 0 1 2 3"), "ends beyond"));
  EXPECT_TRUE(contains(with("4 0 1 2 3", "3 0 1 2 3"), "declares 5"));
  EXPECT_TRUE(contains(with("4 0 1 2 3", "4 0 1 2 -3"), "out of range"));
  EXPECT_TRUE(contains(with("CELLS 1 5", "CELLS 2 5"), "ends beyond"));
  EXPECT_TRUE(contains(with("CELL_TYPES 1\n10", "CELL_TYPES 1\n12"), "in place of 8"));
  EXPECT_TRUE(contains(with("CELL_TYPES 1\n10", "CELL_TYPES 2\n10 10"), "2 cell types"));
  EXPECT_TRUE(contains(with("1 0 0", "1 inf 0"), "not finite"));
  EXPECT_TRUE(contains(with("1 0 0", "1 oops 0"), "test:6"));
  EXPECT_TRUE(contains(with("POINTS 4", "POINTS 400000000000"), "more than the file holds"));
  EXPECT_TRUE(contains(with("POINTS 4", "POINTS 6148914691236517209"), "more"));
  EXPECT_TRUE(contains(with("POINTS 4 float", "POINTS 4 string"), "number type"));
  EXPECT_TRUE(contains(with("UNSTRUCTURED_GRID", "STRUCTURED_POINTS"), "STRUCTURED_POINTS"));
  EXPECT_TRUE(contains(with("CELL_TYPES 1\n10\n", ""), "CELL_TYPES"));
  EXPECT_TRUE(contains(with("CELL_TYPES", "CELL_STUFF"), "unknown keyword"));
  EXPECT_TRUE(contains(with("10\n", "10\nPOINT_DATA 5\n"), "POINT_DATA has 5"));
  EXPECT_TRUE(contains(with("10\n", "10\nPOINT_DATA 4\nFIELD f 2\na 1 4 int\n1 2 3 4"), "FIELD"));
  EXPECT_FALSE(errorOf(readVtk, "").empty());
  EXPECT_FALSE(errorOf(readVtk, "hello").empty());
}

TEST(VtkReader, TruncatedIsRefused) {
  for (const char* begin : {"mixed_", "vtk-data", "mfem"})
    for (const std::string& name : dataFiles(begin, ".vtk"))
      expectTruncatedIsRefused(readVtk, dataPath(name));
}

TEST(VtkReader, DamageIsHarmless) {
  for (const std::string& name : dataFiles("", ".vtk"))
    expectDamageIsHarmless(readVtk, dataPath(name), 1000);
}

} // namespace tetvdb::test
