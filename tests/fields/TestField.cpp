// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/fields/Field.h"

#include <gtest/gtest.h>

namespace {

using namespace tetvdb;
using On = Attribute::On;

TetMesh meshWith(std::vector<Attribute> arrays) {
  TetMesh mesh = meshes::kuhnGrid(1, 1, 1); // 8 points, 6 cells
  mesh.attributes = std::move(arrays);
  return mesh;
}

Attribute ofPoints(const std::string& name, std::uint32_t components, std::size_t numbers = 0) {
  return {name, On::Points, components,
          std::vector<double>(numbers == 0 ? 8 * components : numbers, 1)};
}
Attribute ofCells(const std::string& name, std::uint32_t components) {
  return {name, On::Cells, components, std::vector<float>(6 * components, 1)};
}
Attribute integers(const std::string& name, std::int64_t value) {
  return {name, On::Cells, 1, std::vector<std::int64_t>(6, value)};
}

std::vector<Field> resolve(const TetMesh& mesh, const FieldOptions& options,
                           Report* report = nullptr) {
  Report own;
  return resolveFields(mesh, options, report == nullptr ? own : *report);
}

FieldOptions request(const std::string& array, FieldPart part = FieldPart::Whole,
                     const std::string& component = "", const std::string& grid = "") {
  FieldOptions options;
  options.requests = {{grid, array, part, component}};
  return options;
}

std::string names(const std::vector<Field>& fields) {
  std::string text;
  for (const Field& field : fields)
    text += (text.empty() ? "" : " ") + field.name;
  return text;
}

void expectError(const TetMesh& mesh, const FieldOptions& options, Status status,
                 const std::vector<std::string>& says) {
  try {
    resolve(mesh, options);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), status) << error.what();
    for (const std::string& text : says)
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
  }
}

TEST(Field, KindsByComponentsAndType) {
  const TetMesh mesh =
      meshWith({ofPoints("T", 1), ofPoints("v", 3), integers("k", 3), ofCells("s", 6),
                ofCells("F", 9), ofPoints("uv", 2), ofPoints("q", 4)});
  FieldOptions all;
  all.all = true;
  const auto fields = resolve(mesh, all);
  EXPECT_EQ(names(fields), "T v k s.xx s.yy s.zz s.xy s.yz s.xz F.xx F.xy F.xz F.yx F.yy F.yz F.zx "
                           "F.zy F.zz uv.x uv.y q.0 q.1 q.2 q.3");
  EXPECT_EQ(fields[0].kind, FieldKind::Float);
  EXPECT_EQ(fields[1].kind, FieldKind::Vector);
  EXPECT_EQ(fields[2].kind, FieldKind::Integer);
  EXPECT_EQ(fields[3].kind, FieldKind::Float);
}

TEST(Field, MissingArrayListsThoseThatAreThere) {
  const TetMesh mesh = meshWith({ofPoints("T", 1), ofCells("stress", 6)});
  expectError(mesh, request("nope"), Status::Usage,
              {"no array 'nope'", "'T' (points)", "'stress' (cells, 6 components)"});
  expectError(meshWith({}), request("T"), Status::Usage, {"it has no arrays"});
  FieldOptions all;
  all.all = true;
  expectError(meshWith({}), all, Status::Usage, {"no arrays"});
}

TEST(Field, WrongLengthsAreNamed) {
  expectError(meshWith({ofPoints("T", 1, 7)}), request("T"), Status::Invalid,
              {"'T'", "7 values for 8 points"});
}

TEST(Field, NamesOfPointsAndCells) {
  const TetMesh mesh = meshWith({ofPoints("T", 1), ofCells("T", 1)});
  Report report;
  EXPECT_EQ(resolve(mesh, request("T"), &report)[0].on, On::Points);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0].code, "ambiguous-array");
  const auto cells = resolve(mesh, request("cells:T"));
  EXPECT_EQ(cells[0].on, On::Cells);
  EXPECT_EQ(cells[0].name, "T");
  FieldOptions all;
  all.all = true;
  EXPECT_EQ(names(resolve(mesh, all)), "T T_cells");
  all.requests = {{"", "points:T", FieldPart::Whole, ""}, {"", "cells:T", FieldPart::Whole, ""}};
  expectError(mesh, all, Status::Usage, {"two grids would be named 'T'"});
  all.requests[1].grid = "T2";
  EXPECT_EQ(names(resolve(mesh, all)), "T T2");
}

TEST(Field, BuiltInNamesAreLeftToTheirGrids) {
  FieldOptions all;
  all.all = true;
  EXPECT_EQ(names(resolve(meshWith({ofPoints("density", 1), ofCells("material", 1)}), all)),
            "density_points material_cells");
}

TEST(Field, ComponentsInArraysOfTheirOwn) {
  const TetMesh mesh =
      meshWith({ofPoints("disp_x", 1), ofPoints("disp_y", 1), ofPoints("disp_z", 1),
                ofCells("sXX", 1), ofCells("sYY", 1), ofCells("sZZ", 1), ofCells("sXY", 1),
                ofCells("sYZ", 1), ofCells("sZX", 1)});
  const auto disp = resolve(mesh, request("disp"));
  EXPECT_EQ(disp[0].kind, FieldKind::Vector);
  EXPECT_EQ(disp[0].sources[1].array->name, "disp_y");
  const auto mises = resolve(mesh, request("s", FieldPart::Mises, "", "m"));
  EXPECT_EQ(names(mises), "m");
  EXPECT_EQ(mises[0].sources[2].array->name, "sZX"); // xz
  EXPECT_EQ(mises[0].sources[5].array->name, "sYZ"); // yz
}

TEST(Field, PartsThatATupleDoesNotHave) {
  const TetMesh mesh = meshWith({ofPoints("v", 3), ofCells("s", 6)});
  expectError(mesh, request("v", FieldPart::Mises), Status::Usage, {"'v'", "3 components"});
  expectError(mesh, request("v", FieldPart::Component, "xx"), Status::Usage,
              {"'xx'", "components are x, y, z"});
  expectError(mesh, request("s:foo"), Status::Usage, {"'foo'", "'s'", "mises"});
  EXPECT_EQ(resolve(mesh, request("s", FieldPart::Component, "zx"))[0].sources[0].component, 5u);
  EXPECT_EQ(resolve(mesh, request("s", FieldPart::Component, "4"))[0].sources[0].component, 4u);
}

TEST(Field, IntegersBeyond32Bits) {
  const TetMesh mesh = meshWith({integers("gid", std::int64_t(1) << 40), ofCells("c", 1)});
  expectError(mesh, request("gid"), Status::Invalid, {"'gid'", "beyond 32 bits", "`remap=gid"});
  FieldOptions remapped = request("gid");
  remapped.remap = {{"gid", 0, 1}};
  EXPECT_EQ(resolve(mesh, remapped)[0].kind, FieldKind::Float);
  FieldOptions all;
  all.all = true;
  Report report;
  EXPECT_EQ(names(resolve(mesh, all, &report)), "c");
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0].code, "array-left-out");
}

TEST(Field, RangesNameGrids) {
  FieldOptions options = request("T");
  options.remap = {{"X", 0, 1}};
  expectError(meshWith({ofPoints("T", 1)}), options, Status::Usage, {"`remap`", "'X'", "T"});
}

// A point that no tet uses may hold anything.
TEST(Field, RangeIsOfPointsInUse) {
  TetMesh mesh = meshes::kuhnGrid(1, 1, 1);
  mesh.points.push_back({5, 5, 5});
  mesh.attributes = {ofPoints("T", 1, 9)};
  std::get<std::vector<double>>(mesh.attributes[0].values) = {1, 2, 3, 4, 5, 6, 7, 8, 1e30};
  const auto fields = resolve(mesh, request("T"));
  EXPECT_EQ(fields[0].original.low, 1);
  EXPECT_EQ(fields[0].original.high, 8);
}

} // namespace
