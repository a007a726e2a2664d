// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/FloatPositions.h"

#include "tetvdb/core/ForEachIndex.h"

#include <algorithm>
#include <tbb/parallel_sort.h>
#include <utility>

namespace tetvdb {

FloatPosition asFloats(const Vec3d& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

std::vector<std::uint32_t> equalAsFloats(const std::vector<Vec3d>& points) {
  std::vector<std::pair<FloatPosition, std::uint32_t>> sorted(points.size());
  forEachIndex(sorted.size(), [&](std::size_t v) {
    sorted[v] = {asFloats(points[v]), static_cast<std::uint32_t>(v)};
  });
  tbb::parallel_sort(sorted.begin(), sorted.end());
  std::vector<std::uint32_t> equal;
  for (std::size_t i = 0; i < sorted.size(); ++i)
    if ((i > 0 && sorted[i - 1].first == sorted[i].first) ||
        (i + 1 < sorted.size() && sorted[i + 1].first == sorted[i].first))
      equal.push_back(sorted[i].second);
  return equal;
}

bool areFloats(const std::vector<Vec3d>& points) {
  return std::all_of(points.begin(), points.end(),
                     [](const Vec3d& p) { return nearestFloats(p) == p; });
}

Vec3d nearestFloats(const Vec3d& p) {
  Vec3d rounded;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // GCC 12 removes the conversion to float and back when it vectorizes; volatile prevents it.
    const volatile float c = static_cast<float>(p[axis]);
    rounded[axis] = c;
  }
  return rounded;
}

} // namespace tetvdb
