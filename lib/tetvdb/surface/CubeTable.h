// SPDX-License-Identifier: Apache-2.0
//
// The surface within a cube of eight sample points, for all 256 combinations of inside and outside.
// The table is computed by a rule. docs/algorithms.md proves that the surfaces of adjacent cubes
// form a manifold.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Three cube edges per triangle, counter-clockwise seen from outside the solid. Edge 4 a + u +
/// 2 v is parallel to axis a; u and v are its coordinates along axes (a + 1) % 3 and (a + 2) %
/// 3.
using CubeTriangles = std::vector<std::uint8_t>;

/// Bit c of the index is set if corner (c & 1, c >> 1 & 1, c >> 2) is inside.
const std::array<CubeTriangles, 256>& cubeTable();

/// The first point of an edge, relative to the cube.
constexpr Vec3i cubeEdgeStart(int edge) {
  Vec3i start{0, 0, 0};
  const int axis = edge / 4;
  start[static_cast<std::size_t>((axis + 1) % 3)] = edge & 1;
  start[static_cast<std::size_t>((axis + 2) % 3)] = edge >> 1 & 1;
  return start;
}

} // namespace tetvdb
