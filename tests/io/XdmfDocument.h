// SPDX-License-Identifier: Apache-2.0
//
// XDMF documents of two tets, put together from texts.
#pragma once

#include "io/VtkTestMesh.h"
#include "tetvdb/io/formats/xdmf/XdmfReader.h"

#include <string>
#include <vector>

namespace tetvdb::test {

// Two tets on five points, as texts.
inline const std::string kPoints = "0 0 0  1 0 0  0 1 0  0 0 1  1 1 1";
inline const std::string kTets = "0 1 2 3  4 3 2 1";

inline std::string document(const std::string& domain, const std::string& version = "3.0") {
  return "<?xml version=\"1.0\"?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<Xdmf Version=\"" +
         version + "\" xmlns:xi=\"http://www.w3.org/2001/XInclude\"><Domain>" + domain +
         "</Domain></Xdmf>";
}

inline std::string item(const std::string& dimensions, const std::string& text,
                        const std::string& more = "Format=\"XML\"") {
  return "<DataItem Dimensions=\"" + dimensions + "\" " + more + ">" + text + "</DataItem>";
}

inline std::string topology() {
  return R"(<Topology TopologyType="Tetrahedron" NumberOfElements="2">)" +
         item("2 4", kTets, R"(Format="XML" NumberType="Int")") + "</Topology>";
}
inline std::string geometry() {
  return "<Geometry GeometryType=\"XYZ\">" + item("5 3", kPoints) + "</Geometry>";
}
inline std::string mesh() {
  return topology() + geometry();
}
inline std::string scalar(const std::string& name, const std::string& centre,
                          const std::string& text, const std::string& count) {
  return "<Attribute Name=\"" + name + "\" AttributeType=\"Scalar\" Center=\"" + centre + "\">" +
         item(count, text) + "</Attribute>";
}
inline std::string grid(const std::string& inside,
                        const std::string& attributes = "Name=\"mesh\"") {
  return "<Grid " + attributes + ">" + inside + "</Grid>";
}

inline void expectTwoTets(const CellMesh& mesh) {
  const std::vector<Vec3d> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  EXPECT_EQ(mesh.points, points);
  EXPECT_EQ(mesh.nodes, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 3, 2, 1}));
  ASSERT_EQ(mesh.runs.size(), 1u);
  EXPECT_EQ(mesh.runs[0].type, CellType::Tetra);
  EXPECT_EQ(mesh.runs[0].count, 2u);
}

inline std::vector<double> numbers(const CellMesh& mesh, const std::string& name,
                                   Attribute::On on) {
  const Attribute* array = find(mesh, name, on);
  if (array == nullptr) {
    ADD_FAILURE() << "no array " << name;
    return {};
  }
  std::vector<double> all;
  for (std::size_t i = 0; i < array->size(); ++i)
    for (std::uint32_t c = 0; c < array->components; ++c)
      all.push_back(array->number(i, c));
  return all;
}
using Doubles = std::vector<double>;
constexpr auto kOnPoints = Attribute::On::Points;
constexpr auto kOnCells = Attribute::On::Cells;

} // namespace tetvdb::test
