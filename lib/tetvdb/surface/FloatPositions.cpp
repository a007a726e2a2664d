// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/FloatPositions.h"

#include <algorithm>
#include <numeric>
#include <tbb/parallel_sort.h>

namespace tetvdb {

FloatPosition asFloats(const Vec3d& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

std::vector<std::uint32_t> equalAsFloats(const std::vector<Vec3d>& points) {
  const auto rounded = [&](std::uint32_t v) { return asFloats(points[v]); };
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto p = rounded(a), q = rounded(b);
    return p != q ? p < q : a < b;
  });
  std::vector<std::uint32_t> equal;
  for (std::size_t i = 0; i < order.size(); ++i)
    if ((i > 0 && rounded(order[i - 1]) == rounded(order[i])) ||
        (i + 1 < order.size() && rounded(order[i + 1]) == rounded(order[i])))
      equal.push_back(order[i]);
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
