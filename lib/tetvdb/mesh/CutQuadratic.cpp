// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/mesh/CutQuadratic.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/mesh/AddedValues.h"
#include "tetvdb/mesh/CutTet10.h"
#include "tetvdb/mesh/SplitByShape.h"
#include "tetvdb/mesh/SplitPolyhedron.h"

#include <algorithm>

namespace tetvdb {
namespace {

using Places = std::array<std::uint8_t, 8>;

/// A part of half the size, its corners by their place in the cell.
struct Part {
  CellType type;
  Places places;
};

struct Face {
  std::uint8_t corners[4], mids[4];
};

// In order of the places that they make: 20 to 25, 15 to 17, 13.
constexpr Face kHexahedronFaces[6] = {
    {{0, 3, 7, 4}, {11, 19, 15, 16}}, {{1, 2, 6, 5}, {9, 18, 13, 17}},
    {{0, 1, 5, 4}, {8, 17, 12, 16}},  {{3, 2, 6, 7}, {10, 18, 14, 19}},
    {{0, 1, 2, 3}, {8, 9, 10, 11}},   {{4, 5, 6, 7}, {12, 13, 14, 15}}};
constexpr Face kWedgeFaces[3] = {{{0, 1, 4, 3}, {6, 13, 9, 12}},
                                 {{1, 2, 5, 4}, {7, 14, 10, 13}},
                                 {{2, 0, 3, 5}, {8, 12, 11, 14}}};
constexpr Face kPyramidBase = {{0, 1, 2, 3}, {5, 6, 7, 8}};
constexpr std::uint8_t kHexahedronCorners[8] = {0, 1, 2, 3, 4, 5, 6, 7};
constexpr std::uint8_t kHexahedronMids[12] = {8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19};

std::vector<Part> hexahedronParts() {
  const auto placeAt = [](const Vec3d& at) {
    std::uint8_t i = 0;
    while (placeOf(CurvedShape::Hex27, i) != at)
      ++i;
    return i;
  };
  std::vector<Part> parts;
  for (std::size_t octant = 0; octant < 8; ++octant) {
    const Vec3d corner = placeOf(CurvedShape::Hex27, octant);
    Part part{CellType::Hexahedron, {}};
    for (std::size_t i = 0; i < 8; ++i) {
      const Vec3d own = placeOf(CurvedShape::Hex27, i);
      part.places[i] =
          placeAt({(corner[0] + own[0]) / 2, (corner[1] + own[1]) / 2, (corner[2] + own[2]) / 2});
    }
    parts.push_back(part);
  }
  return parts;
}

std::vector<Part> wedgeParts() {
  constexpr std::uint8_t layers[3][6] = {
      {0, 1, 2, 6, 7, 8}, {12, 13, 14, 15, 16, 17}, {3, 4, 5, 9, 10, 11}};
  constexpr std::uint8_t triangles[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
  std::vector<Part> parts;
  for (std::size_t layer = 0; layer < 2; ++layer)
    for (const auto& triangle : triangles) {
      Part part{CellType::Wedge, {}};
      for (std::size_t i = 0; i < 3; ++i) {
        part.places[i] = layers[layer][triangle[i]];
        part.places[3 + i] = layers[layer + 1][triangle[i]];
      }
      parts.push_back(part);
    }
  return parts;
}

std::vector<Part> pyramidParts() {
  std::vector<Part> parts{{CellType::Pyramid, {9, 10, 11, 12, 4}},
                          {CellType::Pyramid, {12, 11, 10, 9, 13}}};
  for (std::uint8_t i = 0; i < 4; ++i) {
    const auto next = static_cast<std::uint8_t>((i + 1) % 4);
    const auto before = static_cast<std::uint8_t>((i + 3) % 4);
    const auto at = [](int first, int n) { return static_cast<std::uint8_t>(first + n); };
    parts.push_back({CellType::Pyramid, {i, at(5, i), 13, at(5, before), at(9, i)}});
    parts.push_back({CellType::Tetra, {at(5, i), at(9, i), at(9, next), 13}});
  }
  return parts;
}

const std::vector<Part>& partsOf(CurvedShape shape) {
  static const std::vector<Part> hexahedron = hexahedronParts();
  static const std::vector<Part> wedge = wedgeParts();
  static const std::vector<Part> pyramid = pyramidParts();
  switch (shape) {
  case CurvedShape::Hex20:
  case CurvedShape::Hex27:
    return hexahedron;
  case CurvedShape::Wedge15:
  case CurvedShape::Wedge18:
    return wedge;
  default:
    return pyramid;
  }
}

bool signsDiffer(const std::vector<Vec3d>& points, const std::vector<std::uint32_t>& tets,
                 std::size_t from) {
  bool positive = false, negative = false;
  for (std::size_t t = from; t < tets.size(); t += 4) {
    const double volume = sixfoldVolume(points[tets[t]], points[tets[t + 1]], points[tets[t + 2]],
                                        points[tets[t + 3]]);
    positive = positive || volume > 0;
    negative = negative || volume < 0;
  }
  return positive && negative;
}

} // namespace

std::size_t tetsOf(CurvedShape shape) {
  constexpr std::size_t tets[] = {8, 48, 48, 24, 24, 16, 16};
  return tets[static_cast<std::size_t>(shape)];
}

bool QuadraticCutter::cut(CurvedShape shape, const std::uint32_t* nodes,
                          std::vector<std::uint32_t>& tets,
                          std::vector<std::array<std::uint8_t, 4>>& corners) {
  const std::size_t before = tets.size();
  if (shape == CurvedShape::Tet10) {
    for (const auto& places : cutTet10(nodes, points_)) {
      for (const std::uint8_t place : places)
        tets.push_back(nodes[place]);
      corners.push_back(places);
    }
    return signsDiffer(points_, tets, before);
  }
  std::array<std::uint32_t, kMaxCurvedNodes> at{};
  std::copy_n(nodes, nodeCount(shape), at.begin());
  if (shape == CurvedShape::Hex20) {
    for (std::size_t f = 0; f < 6; ++f)
      at[20 + f] = faceCentre(nodes, kHexahedronFaces[f].corners, kHexahedronFaces[f].mids);
    at[26] = add(nodes, kHexahedronCorners, kHexahedronMids, 8);
  } else if (shape == CurvedShape::Wedge15) {
    for (std::size_t f = 0; f < 3; ++f)
      at[15 + f] = faceCentre(nodes, kWedgeFaces[f].corners, kWedgeFaces[f].mids);
  } else if (shape == CurvedShape::Pyramid13) {
    at[13] = faceCentre(nodes, kPyramidBase.corners, kPyramidBase.mids);
  }
  for (const Part& part : partsOf(shape)) {
    std::array<std::uint32_t, 8> own{};
    for (std::size_t i = 0; i < 8; ++i)
      own[i] = at[part.places[i]];
    if (part.type == CellType::Tetra) {
      tets.insert(tets.end(), own.begin(), own.begin() + 4);
      corners.push_back({part.places[0], part.places[1], part.places[2], part.places[3]});
      continue;
    }
    made_.clear();
    const CellShape& form = *shapeOf(part.type);
    splitByShape(form, own.data(), points_.data(), made_);
    for (std::size_t t = 0; t < made_.size(); t += 4) {
      std::array<std::uint8_t, 4> places{};
      for (std::size_t i = 0; i < 4; ++i) {
        const auto corner = std::find(own.begin(), own.begin() + form.corners, made_[t + i]);
        places[i] = part.places[static_cast<std::size_t>(corner - own.begin())];
        tets.push_back(made_[t + i]);
      }
      corners.push_back(places);
    }
  }
  return signsDiffer(points_, tets, before);
}

std::uint32_t QuadraticCutter::add(const std::uint32_t* nodes, const std::uint8_t* corners,
                                   const std::uint8_t* mids, std::size_t cornerCount) {
  Added added{};
  added.corners = static_cast<std::uint8_t>(cornerCount);
  std::uint32_t* to = added.nodes.data();
  for (std::size_t i = 0; i < cornerCount; ++i)
    to[i] = nodes[corners[i]];
  for (std::size_t i = 0; i < added.mids(); ++i)
    to[cornerCount + i] = nodes[mids[i]];
  // Sums of the same numbers in the same order, whatever the cell.
  const auto order = [&](std::uint32_t a, std::uint32_t b) {
    return isBefore(points_.data(), a, b);
  };
  std::sort(to, to + cornerCount, order);
  std::sort(to + cornerCount, to + cornerCount + added.mids(), order);
  if (points_.size() >= 0xfffffffeu)
    throw Error(Status::Limit, "mesh", "more than 4294967294 points, with the centres of faces",
                "split it into several files or choose a part with `bbox` or `region`");
  Vec3d point{0, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    double sum = 0;
    for (std::size_t i = 0; i < cornerCount; ++i)
      sum -= 0.25 * points_[to[i]][k];
    for (std::size_t i = 0; i < added.mids(); ++i)
      sum += added.midWeight() * points_[to[cornerCount + i]][k];
    point[k] = sum;
  }
  points_.push_back(point);
  added_.push_back(added);
  return static_cast<std::uint32_t>(points_.size() - 1);
}

std::uint32_t QuadraticCutter::faceCentre(const std::uint32_t* nodes, const std::uint8_t* corners,
                                          const std::uint8_t* mids) {
  std::array<std::uint32_t, 4> key{};
  for (std::size_t i = 0; i < 4; ++i)
    key[i] = nodes[corners[i]];
  std::sort(key.begin(), key.end());
  const auto known = faces_.find(key);
  if (known != faces_.end()) {
    const std::uint32_t centre = known->second;
    faces_.erase(known); // a face has two cells
    return centre;
  }
  return faces_[key] = add(nodes, corners, mids, 4);
}

std::size_t
QuadraticCutter::FaceHash::operator()(const std::array<std::uint32_t, 4>& corners) const {
  std::uint64_t hash = 0;
  for (const std::uint32_t corner : corners)
    hash = (hash ^ corner) * 0x9E3779B97F4A7C15u;
  return hash ^ hash >> 32;
}

void QuadraticCutter::addValues(Attribute& array) const {
  appendAddedValues(
      array, first_, added_.size(), [&](std::size_t i) { return added_[i].nodes.data(); },
      [&](std::size_t i, double base, const auto& difference) {
        const Added& added = added_[i];
        double sum = base;
        for (std::size_t k = 1; k < added.corners; ++k)
          sum -= 0.25 * difference(k);
        for (std::size_t k = 0; k < added.mids(); ++k)
          sum += added.midWeight() * difference(added.corners + k);
        return sum;
      });
}

} // namespace tetvdb
