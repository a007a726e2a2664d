// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Points by cubes of space, which can be worked on in parallel.
struct CubeRegions {
  std::vector<std::uint32_t> regionOf; ///< by point
  std::uint32_t count = 0;
};

/// Divides the first `count` points by cubes of side `side`, with a corner of one at `corner`
/// sides. An infinite side: one region. Numbered in the order of their first points.
CubeRegions divideByCubes(const std::vector<Vec3d>& points, std::size_t count, double side,
                          double corner);

/// The mean length of the sides of faces, which the sides of cubes are multiples of. `corners`:
/// three point numbers per face. The same for any number of threads.
double meanEdge(const std::vector<Vec3d>& points, const std::vector<std::uint32_t>& corners);

} // namespace tetvdb
