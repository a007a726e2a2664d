// SPDX-License-Identifier: Apache-2.0
//
// How a surface runs through one cube between eight sample points, for every choice of those that
// are inside. Made from a rule, not typed in (docs/algorithms.md has the proof that the cubes'
// surfaces fit together to a manifold).
#pragma once

#include "tetvdb/core/Vec3.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Three edges of the cube a triangle, turning counter-clockwise seen from outside the solid.
/// Edge 4 a + u + 2 v runs along axis a; u and v are its coordinates along axes (a + 1) % 3 and
/// (a + 2) % 3.
using CubeTriangles = std::vector<std::uint8_t>;

/// Bit c of the index tells whether corner (c & 1, c >> 1 & 1, c >> 2) is inside.
const std::array<CubeTriangles, 256>& cubeTable();

/// Where an edge of the cube begins, relative to the cube.
constexpr Vec3i cubeEdgeStart(int edge) {
  Vec3i start{0, 0, 0};
  const int axis = edge / 4;
  start[static_cast<std::size_t>((axis + 1) % 3)] = edge & 1;
  start[static_cast<std::size_t>((axis + 2) % 3)] = edge >> 1 & 1;
  return start;
}

} // namespace tetvdb
