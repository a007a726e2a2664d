// SPDX-License-Identifier: Apache-2.0
//
// Structured and rectilinear grids, judged by the unstructured grid that VTK makes of their visible
// cells.
#include "io/VtkTestMesh.h"
#include "tetvdb/io/formats/vtk/PvtuReader.h"
#include "tetvdb/io/formats/vtk/VtkReader.h"
#include "tetvdb/io/formats/vtk/VtuReader.h"

#include <array>
#include <set>
#include <tuple>
#include <utility>

namespace tetvdb::test {
namespace {

/// The corners of every cell with the values of T there, in no order.
using Corners = std::set<std::array<double, 4>>;
std::vector<Corners> cornersOf(const CellMesh& mesh) {
  const Attribute* values = find(mesh, "T", Attribute::On::Points);
  EXPECT_TRUE(values);
  std::vector<Corners> cells(mesh.nodes.size() / 8);
  for (std::size_t i = 0; values && i < mesh.nodes.size(); ++i) {
    const Vec3d& p = mesh.points.at(mesh.nodes[i]);
    cells[i / 8].insert({p[0], p[1], p[2], values->number(mesh.nodes[i])});
  }
  return cells;
}

CellMesh readMesh(Reader reader, const std::string& name) {
  Report report;
  CellMesh mesh = read(reader, fileBytes(dataPath(name)), report, name);
  EXPECT_TRUE(report.warnings.empty()) << report.warnings[0].text;
  return mesh;
}

const char* const kText = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET STRUCTURED_GRID\n";
const char* const kEightPoints =
    "POINTS 8 float\n0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1\n";
const char* const kStraight =
    "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET RECTILINEAR_GRID\n";

std::string vts(const std::string& extent) {
  return "<VTKFile type=\"StructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">"
         "<StructuredGrid WholeExtent=\"0 1 0 1 0 1\"><Piece Extent=\"" +
         extent +
         "\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">"
         "0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1</DataArray></Points></Piece>"
         "</StructuredGrid></VTKFile>";
}

} // namespace

TEST(StructuredGrids, VisibleCellsAreThoseOfVtk) {
  const CellMesh bent = readMesh(readVtu, "structured_visible.vtu");
  const CellMesh straight = readMesh(readVtu, "rectilinear_visible.vtu");
  ASSERT_EQ(bent.cellCount(), 9u);
  ASSERT_EQ(straight.cellCount(), 6u);
  for (const auto& [reader, name, visible] :
       {std::tuple(&readVtu, "structured.vts", &bent),
        std::tuple(&readVtk, "structured_binary.vtk", &bent),
        std::tuple(&readVtu, "rectilinear.vtr", &straight),
        std::tuple(&readVtk, "rectilinear_ascii.vtk", &straight)}) {
    SCOPED_TRACE(name);
    const CellMesh mesh = readMesh(reader, name);
    EXPECT_EQ(cornersOf(mesh), cornersOf(*visible));
    EXPECT_EQ(mesh.cellCount(), visible->cellCount());
    EXPECT_FALSE(find(mesh, "vtkGhostType", Attribute::On::Cells));
    if (visible == &straight)
      continue;
    const Attribute* number = find(mesh, "number", Attribute::On::Cells);
    ASSERT_TRUE(number);
    EXPECT_EQ(number->values, find(bent, "number", Attribute::On::Cells)->values);
  }
}

TEST(StructuredGrids, HiddenCellsNeedNoArraysToBeAskedFor) {
  ReadOptions options;
  options.attributes = false;
  Report report;
  for (const auto& [reader, name] :
       {std::pair(&readVtu, "structured.vts"), std::pair(&readVtk, "structured_binary.vtk")})
    EXPECT_EQ(read(reader, fileBytes(dataPath(name)), report, name, options).cellCount(), 9u)
        << name;
}

TEST(StructuredGrids, WhatDoesNotFitIsRefused) {
  EXPECT_EQ(read(readVtk, kText + std::string("DIMENSIONS 2 2 2\n") + kEightPoints).cellCount(),
            1u);
  EXPECT_TRUE(contains(errorOf(readVtk, kText + std::string(kEightPoints)), "without DIMENSIONS"));
  EXPECT_TRUE(contains(errorOf(readVtk, kText + std::string("DIMENSIONS 2 2 1\n") + kEightPoints),
                       "declares 4 points, but there are 8"));
  EXPECT_TRUE(contains(errorOf(readVtk, kText + std::string("DIMENSIONS 2 2 3\n") + kEightPoints),
                       "more than the file holds"));
  EXPECT_TRUE(contains(
      errorOf(readVtk,
              kText + std::string("DIMENSIONS 4000000000 4000000000 4000000000\n") + kEightPoints),
      "more than the file holds"));
  EXPECT_TRUE(contains(
      errorOf(readVtk, kText + std::string("DIMENSIONS 2 2 2\nDIMENSIONS 2 2 2\n") + kEightPoints),
      "second section"));
  const std::string x = "X_COORDINATES 2 float\n0 1\n", y = "Y_COORDINATES 2 float\n0 1\n";
  EXPECT_EQ(read(readVtk, kStraight + ("DIMENSIONS 2 2 1\n" + x + y + "Z_COORDINATES 1 float\n0\n"))
                .points.size(),
            4u);
  EXPECT_TRUE(contains(errorOf(readVtk, kStraight + ("DIMENSIONS 2 2 2\n" + x + y)),
                       "2 points along z, but there are 0"));
  EXPECT_TRUE(contains(
      errorOf(readVtk, kStraight + ("DIMENSIONS 1 2 2\n" + x + y + "Z_COORDINATES 1 float\n0\n")),
      "1 points along x, but there are 2"));
  EXPECT_TRUE(
      contains(errorOf(readVtk, kStraight + ("DIMENSIONS 2 2 2\n" + x + x)), "second section"));
  EXPECT_TRUE(contains(errorOf(readVtk, kStraight + std::string("W_COORDINATES 2 float\n0 1\n")),
                       "unknown keyword"));
  EXPECT_EQ(read(readVtu, vts("0 1 0 1 0 1")).cellCount(), 1u);
  EXPECT_EQ(read(readVtu, vts("3 4 -1 0 7 8")).cellCount(), 1u);
  EXPECT_EQ(read(readVtu, vts("0 -1 0 -1 0 -1")).cellCount(), 0u);
  for (const char* extent : {"", "0 1 0 1", "0 1 0 1 0 x", "0 99999999999999 0 1 0 1"})
    EXPECT_TRUE(contains(errorOf(readVtu, vts(extent)), "Extent")) << extent;
  EXPECT_FALSE(errorOf(readVtu, vts("0 1 0 1 0 2")).empty());
}

TEST(StructuredGrids, PiecesAreFoundBesideTheFile) {
  const std::string path = dataPath("index.pvts");
  const std::string text =
      "<VTKFile type=\"PStructuredGrid\"><PStructuredGrid>"
      "<Piece Extent=\"0 3 0 2 0 2\" Source=\"structured.vts\"/></PStructuredGrid></VTKFile>";
  Report report;
  EXPECT_EQ(read(readPvtu, text, report, path).cellCount(), 9u);
  Progress progress;
  EXPECT_TRUE(pvtuHasSolidCells({text, path}, report, progress));
  EXPECT_EQ(sniffFormat(text, path), FileFormat::Pvtu);
  EXPECT_EQ(sniffFormat(fileBytes(dataPath("structured.vts")), "x"), FileFormat::Vts);
  EXPECT_EQ(sniffFormat(fileBytes(dataPath("rectilinear.vtr")), "x"), FileFormat::Vts);
}

TEST(StructuredGrids, TruncatedIsRefusedAndDamageIsHarmless) {
  expectTruncatedIsRefused(readVtu, dataPath("structured.vts"));
  expectDamageIsHarmless(readVtu, dataPath("structured.vts"), 500);
  expectDamageIsHarmless(readVtu, dataPath("rectilinear.vtr"), 500);
  expectDamageIsHarmless(readVtk, dataPath("structured_binary.vtk"), 500);
  expectDamageIsHarmless(readVtk, dataPath("rectilinear_ascii.vtk"), 500);
}

} // namespace tetvdb::test
