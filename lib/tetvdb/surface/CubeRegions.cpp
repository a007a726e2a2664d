// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CubeRegions.h"

#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace tetvdb {

CubeRegions divideByCubes(const std::vector<Vec3d>& points, std::size_t count, double side,
                          double corner) {
  CubeRegions regions;
  regions.regionOf.assign(count, 0);
  regions.count = count > 0 ? 1 : 0;
  if (!(side < std::numeric_limits<double>::infinity()))
    return regions;
  std::vector<Vec3i> cubes(count);
  forEachIndex(count, [&](std::size_t v) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      cubes[v][axis] = static_cast<std::int32_t>(
          std::clamp(std::floor(points[v][axis] / side + corner), -1e9, 1e9));
  });
  std::map<Vec3i, std::uint32_t> numbers;
  for (std::size_t v = 0; v < count; ++v)
    regions.regionOf[v] =
        v > 0 && cubes[v] == cubes[v - 1] // as a rule
            ? regions.regionOf[v - 1]
            : numbers.try_emplace(cubes[v], static_cast<std::uint32_t>(numbers.size()))
                  .first->second;
  regions.count = static_cast<std::uint32_t>(numbers.size());
  return regions;
}

double meanEdge(const std::vector<Vec3d>& points, const std::vector<std::uint32_t>& corners) {
  const double sum = sumOver(corners.size(), [&](std::size_t side) {
    const std::size_t next = side % 3 == 2 ? side - 2 : side + 1;
    return length(minus(points[corners[next]], points[corners[side]]));
  });
  return sum / static_cast<double>(corners.size());
}

} // namespace tetvdb
