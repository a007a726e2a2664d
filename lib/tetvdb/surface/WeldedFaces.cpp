// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/WeldedFaces.h"

#include <tbb/parallel_sort.h>
#include <tuple>
#include <utility>

namespace tetvdb {

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
