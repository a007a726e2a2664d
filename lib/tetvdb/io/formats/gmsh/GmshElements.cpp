// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/gmsh/GmshElements.h"

#include <array>
#include <cstddef>

namespace tetvdb {
namespace {

constexpr std::size_t kTypes = 141;

constexpr CellKind flat(const char* name, std::uint32_t nodes) {
  return {name, CellType::Flat, 0, nodes};
}
constexpr CellKind tetra(const char* name, std::uint32_t nodes) {
  return {name, CellType::Tetra, 4, nodes};
}
constexpr CellKind hexahedron(const char* name, std::uint32_t nodes) {
  return {name, CellType::Hexahedron, 8, nodes};
}
constexpr CellKind wedge(const char* name, std::uint32_t nodes) {
  return {name, CellType::Wedge, 6, nodes};
}
constexpr CellKind pyramid(const char* name, std::uint32_t nodes) {
  return {name, CellType::Pyramid, 5, nodes};
}
// Of kept nodes in VTK's order their place in Gmsh's ("Node ordering" in its reference manual,
// which gives each type's edges and faces).
constexpr std::uint8_t kTetra10[] = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};
constexpr std::uint8_t kHexahedron27[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  11, 13, 9,  16, 18,
                                          19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25, 26};
constexpr std::uint8_t kWedge18[] = {0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11, 15, 17, 16};
constexpr std::uint8_t kPyramid14[] = {0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12, 13};

constexpr CellKind curved(CellKind kind, const std::uint8_t* order) {
  kind.kept = kind.nodes;
  kind.order = order;
  return kind;
}
constexpr CellKind pointwise(const char* name) {
  return {name, CellType::OtherSolid, 0, 1};
}

/// Number of nodes of the flat types that have no name of their own below.
constexpr std::array<std::array<std::uint32_t, 2>, 46> kFlatNodes{
    {{1, 2},    {2, 3},   {3, 4},   {8, 3},   {9, 6},   {10, 9},  {15, 1},  {16, 8},
     {20, 9},   {21, 10}, {22, 12}, {23, 15}, {24, 15}, {25, 21}, {26, 4},  {27, 5},
     {28, 6},   {36, 16}, {37, 25}, {38, 36}, {39, 12}, {40, 16}, {41, 20}, {42, 28},
     {43, 36},  {44, 45}, {45, 55}, {46, 66}, {47, 49}, {48, 64}, {49, 81}, {50, 100},
     {51, 121}, {52, 18}, {53, 21}, {54, 24}, {55, 27}, {56, 30}, {57, 24}, {58, 28},
     {59, 32},  {60, 36}, {61, 40}, {138, 4}, {140, 4}, {62, 7}}};

std::array<CellKind, kTypes> makeKinds() {
  std::array<CellKind, kTypes> kinds{};
  for (const auto& [type, nodes] : kFlatNodes)
    kinds[type] = flat("surface element of higher order", nodes);
  kinds[1] = flat("line", 2);
  kinds[2] = flat("triangle", 3);
  kinds[3] = flat("quad", 4);
  kinds[8] = flat("line3", 3);
  kinds[9] = flat("triangle6", 6);
  kinds[10] = flat("quad9", 9);
  kinds[15] = flat("point", 1);
  kinds[16] = flat("quad8", 8);
  for (std::uint32_t i = 0; i < 5; ++i) // lines of order 6 to 10
    kinds[62 + i] = flat("line of higher order", 7 + i);
  for (std::uint32_t i = 0; i < 3; ++i) // lines, triangles, quads of order 0
    kinds[84 + i] = flat("element of order 0", 1);

  kinds[4] = tetra("tetra", 4);
  kinds[11] = curved(tetra("tetra10", 10), kTetra10);
  kinds[29] = tetra("tetra20", 20);
  kinds[30] = tetra("tetra35", 35);
  kinds[31] = tetra("tetra56", 56);
  kinds[32] = tetra("tetra22", 22);
  kinds[33] = tetra("tetra28", 28);
  kinds[71] = tetra("tetra84", 84);
  kinds[72] = tetra("tetra120", 120);
  kinds[73] = tetra("tetra165", 165);
  kinds[74] = tetra("tetra220", 220);
  kinds[75] = tetra("tetra286", 286);
  kinds[79] = tetra("tetra34", 34);
  kinds[80] = tetra("tetra40", 40);
  kinds[81] = tetra("tetra46", 46);
  kinds[82] = tetra("tetra52", 52);
  kinds[83] = tetra("tetra58", 58);
  kinds[137] = tetra("tetra16", 16);
  kinds[139] = tetra("tetra5", 5);

  kinds[5] = hexahedron("hexahedron", 8);
  kinds[12] = curved(hexahedron("hexahedron27", 27), kHexahedron27);
  kinds[17] = curved(hexahedron("hexahedron20", 20), kHexahedron27);
  kinds[92] = hexahedron("hexahedron64", 64);
  kinds[93] = hexahedron("hexahedron125", 125);
  kinds[94] = hexahedron("hexahedron216", 216);
  kinds[95] = hexahedron("hexahedron343", 343);
  kinds[96] = hexahedron("hexahedron512", 512);
  kinds[97] = hexahedron("hexahedron729", 729);
  kinds[98] = hexahedron("hexahedron1000", 1000);
  kinds[99] = hexahedron("hexahedron32", 32);
  kinds[100] = hexahedron("hexahedron44", 44);
  kinds[101] = hexahedron("hexahedron56", 56);
  kinds[102] = hexahedron("hexahedron68", 68);
  kinds[103] = hexahedron("hexahedron80", 80);
  kinds[104] = hexahedron("hexahedron92", 92);
  kinds[105] = hexahedron("hexahedron104", 104);

  kinds[6] = wedge("wedge", 6);
  kinds[13] = curved(wedge("wedge18", 18), kWedge18);
  kinds[18] = curved(wedge("wedge15", 15), kWedge18);
  kinds[90] = wedge("wedge40", 40);
  kinds[91] = wedge("wedge75", 75);
  kinds[106] = wedge("wedge126", 126);
  kinds[107] = wedge("wedge196", 196);
  kinds[108] = wedge("wedge288", 288);
  kinds[109] = wedge("wedge405", 405);
  kinds[110] = wedge("wedge550", 550);
  kinds[111] = wedge("wedge24", 24);
  kinds[112] = wedge("wedge33", 33);
  kinds[113] = wedge("wedge42", 42);
  kinds[114] = wedge("wedge51", 51);
  kinds[115] = wedge("wedge60", 60);
  kinds[116] = wedge("wedge69", 69);
  kinds[117] = wedge("wedge78", 78);

  kinds[7] = pyramid("pyramid", 5);
  kinds[14] = curved(pyramid("pyramid14", 14), kPyramid14);
  kinds[19] = curved(pyramid("pyramid13", 13), kPyramid14);
  kinds[118] = pyramid("pyramid30", 30);
  kinds[119] = pyramid("pyramid55", 55);
  kinds[120] = pyramid("pyramid91", 91);
  kinds[121] = pyramid("pyramid140", 140);
  kinds[122] = pyramid("pyramid204", 204);
  kinds[123] = pyramid("pyramid285", 285);
  kinds[124] = pyramid("pyramid385", 385);
  kinds[125] = pyramid("pyramid21", 21);
  kinds[126] = pyramid("pyramid29", 29);
  kinds[127] = pyramid("pyramid37", 37);
  kinds[128] = pyramid("pyramid45", 45);
  kinds[129] = pyramid("pyramid53", 53);
  kinds[130] = pyramid("pyramid61", 61);
  kinds[131] = pyramid("pyramid69", 69);

  kinds[87] = pointwise("tetra of order 0");
  kinds[88] = pointwise("hexahedron of order 0");
  kinds[89] = pointwise("wedge of order 0");
  kinds[132] = pointwise("pyramid of order 0");
  return kinds;
}

} // namespace

const CellKind* gmshElement(std::int64_t type) {
  static const std::array<CellKind, kTypes> kinds = makeKinds();
  if (type < 0 || type >= static_cast<std::int64_t>(kTypes))
    return nullptr;
  const CellKind& kind = kinds[static_cast<std::size_t>(type)];
  return kind.name == nullptr ? nullptr : &kind;
}

} // namespace tetvdb
