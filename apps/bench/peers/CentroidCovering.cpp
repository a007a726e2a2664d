// SPDX-License-Identifier: Apache-2.0
#include "CentroidCovering.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

namespace tetvdb::bench {

TriangleMesh centroidCovering(const TriangleMesh& mesh) {
  TriangleMesh covering;
  covering.points = mesh.points;
  covering.triangles = mesh.triangles;
  Vec3d centroid{0, 0, 0};
  for (const Vec3d& p : mesh.points)
    for (std::size_t axis = 0; axis < 3; ++axis)
      centroid[axis] += p[axis] / static_cast<double>(mesh.points.size());
  const auto tip = static_cast<std::uint32_t>(covering.points.size());
  covering.points.push_back(centroid);

  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> isOdd;
  for (std::size_t corner = 0; corner < mesh.triangles.size(); ++corner) {
    const std::size_t next = corner % 3 == 2 ? corner - 2 : corner + 1;
    const auto [low, high] = std::minmax(mesh.triangles[corner], mesh.triangles[next]);
    bool& odd = isOdd[{low, high}];
    odd = !odd;
  }
  for (const auto& [edge, odd] : isOdd)
    if (odd)
      covering.triangles.insert(covering.triangles.end(), {edge.first, edge.second, tip});
  return covering;
}

} // namespace tetvdb::bench
