// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/WeldedFaces.h"

#include <tbb/parallel_sort.h>
#include <tuple>
#include <utility>

namespace tetvdb {

WeldedFace ascendingFace(const std::vector<Vec3d>& points, std::array<std::uint32_t, 3> c,
                         std::int32_t weight) {
  const auto order = [&](std::size_t i, std::size_t k) {
    if (points[c[k]] < points[c[i]]) {
      std::swap(c[i], c[k]);
      weight = -weight;
    }
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return {c, weight};
}

BoxBlocks faceBoxes(const WeldedFaces& welded) {
  return BoxBlocks(welded.faces.size(), [&](std::size_t i) {
    Box box;
    for (const Vec3d& corner : welded.cornersOf(i))
      box.add(corner);
    return box;
  });
}

void mergeEqualFaces(WeldedFaces& welded) {
  std::vector<WeldedFace> all = std::move(welded.faces);
  welded.faces.clear();
  tbb::parallel_sort(all.begin(), all.end(), [](const WeldedFace& a, const WeldedFace& b) {
    return std::tie(a.corners, a.weight) < std::tie(b.corners, b.weight);
  });
  for (std::size_t i = 0; i < all.size();) {
    WeldedFace sum = all[i];
    const std::size_t begin = i;
    for (++i; i < all.size() && all[i].corners == sum.corners; ++i)
      sum.weight += all[i].weight;
    if (sum.weight != 0)
      welded.faces.push_back(sum);
    else
      welded.cancelled += i - begin;
  }
}

} // namespace tetvdb
