// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/gmsh/GmshElements.h"

#include <array>
#include <cstddef>

namespace tetvdb {
namespace {

constexpr std::size_t kTypes = 141;

// Of kept nodes in VTK's order their place in Gmsh's ("Node ordering" in its reference manual,
// which gives each type's edges and faces).
constexpr std::uint8_t kTetra10[] = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};
constexpr std::uint8_t kHexahedron27[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  11, 13, 9,  16, 18,
                                          19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25, 26};
constexpr std::uint8_t kWedge18[] = {0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11, 15, 17, 16};
constexpr std::uint8_t kPyramid14[] = {0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12, 13};

/// A type of elements: its number, name and nodes; `order`: of a curved one.
struct Row {
  std::uint8_t type;
  const char* name;
  std::uint32_t nodes;
  const std::uint8_t* order = nullptr;
};
constexpr Row kFlats[] = {{1, "line", 2},   {2, "triangle", 3},  {3, "quad", 4},
                          {8, "line3", 3},  {9, "triangle6", 6}, {10, "quad9", 9},
                          {15, "point", 1}, {16, "quad8", 8}};
constexpr Row kTetras[] = {
    {4, "tetra", 4},       {11, "tetra10", 10, kTetra10}, {29, "tetra20", 20},
    {30, "tetra35", 35},   {31, "tetra56", 56},           {32, "tetra22", 22},
    {33, "tetra28", 28},   {71, "tetra84", 84},           {72, "tetra120", 120},
    {73, "tetra165", 165}, {74, "tetra220", 220},         {75, "tetra286", 286},
    {79, "tetra34", 34},   {80, "tetra40", 40},           {81, "tetra46", 46},
    {82, "tetra52", 52},   {83, "tetra58", 58},           {137, "tetra16", 16},
    {139, "tetra5", 5}};
constexpr Row kHexahedra[] = {{5, "hexahedron", 8},
                              {12, "hexahedron27", 27, kHexahedron27},
                              {17, "hexahedron20", 20, kHexahedron27},
                              {92, "hexahedron64", 64},
                              {93, "hexahedron125", 125},
                              {94, "hexahedron216", 216},
                              {95, "hexahedron343", 343},
                              {96, "hexahedron512", 512},
                              {97, "hexahedron729", 729},
                              {98, "hexahedron1000", 1000},
                              {99, "hexahedron32", 32},
                              {100, "hexahedron44", 44},
                              {101, "hexahedron56", 56},
                              {102, "hexahedron68", 68},
                              {103, "hexahedron80", 80},
                              {104, "hexahedron92", 92},
                              {105, "hexahedron104", 104}};
constexpr Row kWedges[] = {
    {6, "wedge", 6},        {13, "wedge18", 18, kWedge18}, {18, "wedge15", 15, kWedge18},
    {90, "wedge40", 40},    {91, "wedge75", 75},           {106, "wedge126", 126},
    {107, "wedge196", 196}, {108, "wedge288", 288},        {109, "wedge405", 405},
    {110, "wedge550", 550}, {111, "wedge24", 24},          {112, "wedge33", 33},
    {113, "wedge42", 42},   {114, "wedge51", 51},          {115, "wedge60", 60},
    {116, "wedge69", 69},   {117, "wedge78", 78}};
constexpr Row kPyramids[] = {{7, "pyramid", 5},
                             {14, "pyramid14", 14, kPyramid14},
                             {19, "pyramid13", 13, kPyramid14},
                             {118, "pyramid30", 30},
                             {119, "pyramid55", 55},
                             {120, "pyramid91", 91},
                             {121, "pyramid140", 140},
                             {122, "pyramid204", 204},
                             {123, "pyramid285", 285},
                             {124, "pyramid385", 385},
                             {125, "pyramid21", 21},
                             {126, "pyramid29", 29},
                             {127, "pyramid37", 37},
                             {128, "pyramid45", 45},
                             {129, "pyramid53", 53},
                             {130, "pyramid61", 61},
                             {131, "pyramid69", 69}};
constexpr Row kPoints[] = {{87, "tetra of order 0", 1},
                           {88, "hexahedron of order 0", 1},
                           {89, "wedge of order 0", 1},
                           {132, "pyramid of order 0", 1}};

/// Number of nodes of the flat types that have no name of their own.
constexpr std::array<std::array<std::uint32_t, 2>, 46> kFlatNodes{
    {{1, 2},    {2, 3},   {3, 4},   {8, 3},   {9, 6},   {10, 9},  {15, 1},  {16, 8},
     {20, 9},   {21, 10}, {22, 12}, {23, 15}, {24, 15}, {25, 21}, {26, 4},  {27, 5},
     {28, 6},   {36, 16}, {37, 25}, {38, 36}, {39, 12}, {40, 16}, {41, 20}, {42, 28},
     {43, 36},  {44, 45}, {45, 55}, {46, 66}, {47, 49}, {48, 64}, {49, 81}, {50, 100},
     {51, 121}, {52, 18}, {53, 21}, {54, 24}, {55, 27}, {56, 30}, {57, 24}, {58, 28},
     {59, 32},  {60, 36}, {61, 40}, {138, 4}, {140, 4}, {62, 7}}};

std::array<CellKind, kTypes> makeKinds() {
  std::array<CellKind, kTypes> kinds{};
  const auto set = [&](std::size_t type, const char* name, std::uint32_t nodes, CellType shape,
                       std::uint32_t corners) {
    kinds[type] = {name, shape, corners, nodes};
  };
  const auto setAll = [&](const auto& rows, CellType shape, std::uint32_t corners) {
    for (const Row& row : rows) {
      set(row.type, row.name, row.nodes, shape, corners);
      if (row.order != nullptr) {
        kinds[row.type].kept = row.nodes;
        kinds[row.type].order = row.order;
      }
    }
  };
  for (const auto& [type, nodes] : kFlatNodes)
    set(type, "surface element of higher order", nodes, CellType::Flat, 0);
  for (std::uint32_t i = 0; i < 5; ++i) // lines of order 6 to 10
    set(62 + i, "line of higher order", 7 + i, CellType::Flat, 0);
  for (std::uint32_t i = 0; i < 3; ++i) // lines, triangles, quads of order 0
    set(84 + i, "element of order 0", 1, CellType::Flat, 0);
  setAll(kFlats, CellType::Flat, 0);
  setAll(kTetras, CellType::Tetra, 4);
  setAll(kHexahedra, CellType::Hexahedron, 8);
  setAll(kWedges, CellType::Wedge, 6);
  setAll(kPyramids, CellType::Pyramid, 5);
  setAll(kPoints, CellType::OtherSolid, 0);
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

const CellKind* gmshFace(std::int64_t type) {
  static const std::array<CellKind, kTypes> faces = [] {
    std::array<CellKind, kTypes> made{};
    for (const std::size_t triangle : {2u, 9u})
      (made[triangle] = *gmshElement(std::int64_t(triangle))).corners = 3;
    for (const std::size_t quad : {3u, 10u, 16u})
      (made[quad] = *gmshElement(std::int64_t(quad))).corners = 4;
    return made;
  }();
  if (type < 0 || type >= static_cast<std::int64_t>(kTypes))
    return nullptr;
  const CellKind& face = faces[static_cast<std::size_t>(type)];
  return face.corners == 0 ? nullptr : &face;
}

} // namespace tetvdb
