// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/mesh/SplitByShape.h"

#include "tetvdb/mesh/SplitPolyhedron.h"

#include <algorithm>
#include <utility>

namespace tetvdb {
namespace {

CellShape prism(int sides) {
  CellShape shape{2 * sides, 3 * (sides - 2), {{}, {}}};
  for (int i = 0; i < sides; ++i) {
    const int next = (i + 1) % sides;
    shape.faces[0].push_back(sides - 1 - i);
    shape.faces[1].push_back(sides + i);
    shape.faces.push_back({i, next, next + sides, i + sides});
  }
  return shape;
}

} // namespace

const CellShape* shapeOf(CellType type) {
  static const CellShape voxel{
      8, 6, {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  static const CellShape pyramid{5, 2, {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
  static const CellShape wedge = prism(3);
  static const CellShape hexahedron = prism(4);
  static const CellShape pentagonal = prism(5);
  static const CellShape hexagonal = prism(6);
  switch (type) {
  case CellType::Voxel:
    return &voxel;
  case CellType::Hexahedron:
    return &hexahedron;
  case CellType::Wedge:
    return &wedge;
  case CellType::Pyramid:
    return &pyramid;
  case CellType::PentagonalPrism:
    return &pentagonal;
  case CellType::HexagonalPrism:
    return &hexagonal;
  default:
    return nullptr;
  }
}

bool splitByShape(const CellShape& shape, const std::uint32_t* nodes, const Vec3d* points,
                  std::vector<std::uint32_t>& tets) {
  std::uint32_t apex = nodes[0];
  for (int i = 1; i < shape.corners; ++i)
    if (isBefore(points, nodes[i], apex))
      apex = nodes[i];
  bool positive = false;
  bool negative = false;
  for (const std::vector<int>& face : shape.faces) {
    std::array<std::uint32_t, 6> corner;
    const std::size_t sides = face.size();
    std::size_t first = 0;
    bool atApex = false;
    for (std::size_t i = 0; i < sides; ++i) {
      corner[i] = nodes[face[i]];
      // By number, not by place: collapsed cells repeat a corner.
      atApex = atApex || corner[i] == apex;
      if (isBefore(points, corner[i], corner[first]))
        first = i;
    }
    if (atApex)
      continue;
    for (std::size_t i = 1; i + 1 < sides; ++i) {
      const std::uint32_t a = corner[first];
      const std::uint32_t b = corner[(first + i) % sides];
      const std::uint32_t c = corner[(first + i + 1) % sides];
      if (a == b || b == c || c == a)
        continue;
      const double volume = sixfoldVolume(points[apex], points[a], points[b], points[c]);
      positive = positive || volume > 0;
      negative = negative || volume < 0;
      tets.insert(tets.end(), {apex, a, b, c});
    }
  }
  return positive && negative;
}

LinearCell::LinearCell(CurvedShape shape, CellType type, const std::uint32_t* corners)
    : shape_(shape), count_(nodeCount(shape)) {
  std::copy_n(corners, count_, nodes_.begin());
  if (type == CellType::Voxel) {
    std::swap(nodes_[2], nodes_[3]);
    std::swap(nodes_[6], nodes_[7]);
  }
}

std::array<std::uint8_t, 4> LinearCell::placesOf(const std::uint32_t* tet) const {
  std::array<std::uint8_t, 4> places{};
  for (std::size_t i = 0; i < 4; ++i)
    places[i] = static_cast<std::uint8_t>(std::find(begin(), end(), tet[i]) - begin());
  return places;
}

void warnConcave(std::size_t cells, Report& report) {
  if (cells > 0)
    report.warn("concave-cells", std::to_string(cells) +
                                     " cells are not convex or turned inside out in places; their "
                                     "tetrahedra overlap there");
}

} // namespace tetvdb
