// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CubeRegions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace tetvdb {

CubeRegions divideByCubes(const std::vector<Vec3d>& points, std::size_t count, double side,
                          double corner) {
  CubeRegions regions;
  regions.regionOf.resize(count);
  std::map<Vec3i, std::uint32_t> numbers;
  for (std::size_t v = 0; v < count; ++v) {
    Vec3i cube{0, 0, 0};
    if (side < std::numeric_limits<double>::infinity())
      for (std::size_t axis = 0; axis < 3; ++axis)
        cube[axis] = static_cast<std::int32_t>(
            std::clamp(std::floor(points[v][axis] / side + corner), -1e9, 1e9));
    regions.regionOf[v] = numbers.try_emplace(cube, regions.count).first->second;
    regions.count = static_cast<std::uint32_t>(numbers.size());
  }
  return regions;
}

} // namespace tetvdb
