// SPDX-License-Identifier: Apache-2.0
//
// Structured grids of XDMF. The points expected are those that VTK's reader makes of the same text
// (9.5, vtkXdmfReader): dimensions, origins and spacings are listed along z first.
#include "io/VtkTestMesh.h"
#include "io/XdmfDocument.h"
#include "tetvdb/io/formats/xdmf/XdmfReader.h"

namespace tetvdb::test {
namespace {

std::string structured(const std::string& type, const std::string& dimensions,
                       const std::string& points, const std::string& more = {}) {
  return document(grid("<Topology TopologyType=\"" + type + "\" Dimensions=\"" + dimensions +
                       "\"/>" + points + more));
}
std::string points(const std::string& type, const std::string& items) {
  return "<Geometry GeometryType=\"" + type + "\">" + items + "</Geometry>";
}

/// x, y or z of the bent grid's 24 points, or all three of each.
std::string bent(int axis) {
  std::string text;
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 2; ++i) {
        const double p[] = {i + 0.25 * j, double(j), k + 0.5 * i};
        for (int a = 0; a < 3; ++a)
          if (axis < 0 || a == axis)
            text += std::to_string(p[a]) + " ";
      }
  return text;
}

} // namespace

TEST(XdmfBlocks, PointsAreVtks) {
  const auto straight = points("ORIGIN_DXDYDZ", item("3", "10 20 30") + item("3", "1 2 3"));
  const CellMesh uniform = read(readXdmf, structured("3DCoRectMesh", "4 3 2", straight));
  ASSERT_EQ(uniform.points.size(), 24u);
  EXPECT_EQ(uniform.points[0], (Vec3d{30, 20, 10}));
  EXPECT_EQ(uniform.points[1], (Vec3d{33, 20, 10}));
  EXPECT_EQ(uniform.points[2], (Vec3d{30, 22, 10}));
  EXPECT_EQ(uniform.points[23], (Vec3d{33, 24, 13}));
  const auto axes =
      points("VXVYVZ", item("2", "1 3") + item("3", "0 2 5") + item("4", "7 8 10 13"));
  const CellMesh rectilinear = read(readXdmf, structured("3DRectMesh", "4 3 2", axes));
  ASSERT_EQ(rectilinear.points.size(), 24u);
  EXPECT_EQ(rectilinear.points[1], (Vec3d{3, 0, 7}));
  EXPECT_EQ(rectilinear.points[2], (Vec3d{1, 2, 7}));
  EXPECT_EQ(rectilinear.points[23], (Vec3d{3, 5, 13}));
  for (const CellMesh* mesh : {&uniform, &rectilinear}) {
    ASSERT_EQ(mesh->runs.size(), 1u);
    EXPECT_EQ(mesh->runs[0].type, CellType::Hexahedron);
    EXPECT_EQ(mesh->cellCount(), 6u);
  }
}

TEST(XdmfBlocks, BentGridsWithValuesInEitherForm) {
  const std::string values =
      scalar("T", "Node", "0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23", "24") +
      scalar("c", "Cell", "0 1 2 3 4 5", "3 2 1");
  const CellMesh together = read(
      readXdmf, structured("3DSMesh", "4 3 2", points("XYZ", item("4 3 2 3", bent(-1))), values));
  const CellMesh apart =
      read(readXdmf, structured("3DSMesh", "4 3 2",
                                points("X_Y_Z", item("4 3 2", bent(0)) + item("4 3 2", bent(1)) +
                                                    item("4 3 2", bent(2))),
                                values));
  EXPECT_EQ(together.points, apart.points);
  EXPECT_EQ(together.nodes, apart.nodes);
  ASSERT_EQ(together.points.size(), 24u);
  EXPECT_EQ(together.points[3], (Vec3d{1.25, 1, 0.5}));
  const Attribute* t = find(together, "T", Attribute::On::Points);
  const Attribute* c = find(together, "c", Attribute::On::Cells);
  ASSERT_TRUE(t && c);
  EXPECT_EQ(t->number(23), 23);
  EXPECT_EQ(c->number(5), 5);
}

TEST(XdmfBlocks, SheetsAreTriangles) {
  ReadOptions options;
  options.faces = true;
  Report report;
  const CellMesh mesh =
      read(readXdmf,
           structured("2DSMesh", "3 2", points("XY", item("3 2 2", "0 0 1 0 0 1 1 1 0 2 1 2"))),
           report, "test", options);
  EXPECT_EQ(mesh.points[3], (Vec3d{1, 1, 0}));
  ASSERT_EQ(mesh.runs.size(), 1u);
  EXPECT_EQ(mesh.runs[0].type, CellType::Flat);
  EXPECT_EQ(mesh.nodes.size(), 2u * 4);
}

TEST(XdmfBlocks, WhatDoesNotFitIsRefused) {
  const auto error = [](const std::string& type, const std::string& dimensions,
                        const std::string& given) {
    return errorOf(readXdmf, structured(type, dimensions, given));
  };
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  const auto origin = points("ORIGIN_DXDYDZ", item("3", "0 0 0") + item("3", "1 1 1"));
  const auto axes =
      points("VXVYVZ", item("2", "1 3") + item("3", "0 2 5") + item("4", "7 8 10 13"));
  for (const char* dimensions : {"", "4", "0 2 2", "2 2 2 2", "-1 2 2"})
    has(error("3DCoRectMesh", dimensions, origin), "numbers of points");
  // Declared by a few bytes: more than 2^22 points, and far more.
  has(error("3DCoRectMesh", "200 200 200", origin), "more than the file holds");
  has(error("3DCoRectMesh", "4000000 4000000 4000000", origin), "more than the file holds");
  has(error("3DRectMesh", "4 3 3", axes), "2 coordinates along an axis of 3 points");
  has(error("3DRectMesh", "2 3 4", axes), "2 coordinates along an axis of 4 points");
  has(error("3DCoRectMesh", "2 2 2",
            points("ORIGIN_DXDYDZ", item("2", "0 0") + item("3", "1 1 1"))),
      "origin");
  has(error("3DCoRectMesh", "2 2 2", points("ORIGIN_DXDYDZ", item("3", "0 0 0"))), "too few");
  has(error("3DCoRectMesh", "2 2 2", points("RADIAL", item("3", "0 0 0"))), "RADIAL");
  has(error("3DCoRectMesh", "2 2 2",
            points("ORIGIN_DXDYDZ", item("3", "0 0 0") + item("3", "1 1 inf"))),
      "not finite");
}

} // namespace tetvdb::test
