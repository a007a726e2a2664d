// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CanonicalOrder.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tuple>

namespace tetvdb {

CanonicalOrder canonicalOrder(const TriangleMesh& mesh) {
  CanonicalOrder canonical;
  // The first coordinate, which decides most comparisons, is stored with the number.
  struct Point {
    double x;
    std::uint32_t was;
  };
  std::vector<Point> points(mesh.points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i)
    points[i] = {mesh.points[i][0], i};
  tbb::parallel_sort(points.begin(), points.end(), [&](const Point& a, const Point& b) {
    return a.x != b.x ? a.x < b.x : mesh.points[a.was] < mesh.points[b.was];
  });
  std::vector<std::uint32_t> rank(mesh.points.size());
  canonical.mesh.points.resize(mesh.points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    rank[points[i].was] = i;
    for (std::size_t axis = 0; axis < 3; ++axis) // -0 becomes 0
      canonical.mesh.points[i][axis] = mesh.points[points[i].was][axis] + 0.0;
  }

  struct Face {
    std::array<std::uint32_t, 3> corners;
    std::uint32_t was;
  };
  // Sorts by the first corner, which few faces share, then the faces of each first corner.
  std::vector<std::size_t> firstOf(points.size() + 1, 0);
  const auto firstCorner = [&](std::size_t face) {
    const std::uint32_t* v = &mesh.triangles[3 * face];
    return std::min({rank[v[0]], rank[v[1]], rank[v[2]]});
  };
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face)
    ++firstOf[firstCorner(face) + 1];
  std::partial_sum(firstOf.begin(), firstOf.end(), firstOf.begin());
  std::vector<Face> faces(mesh.triangleCount());
  std::vector<std::size_t> next(firstOf.begin(), firstOf.end() - 1);
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face) {
    Face f;
    for (std::size_t k = 0; k < 3; ++k)
      f.corners[k] = rank[mesh.triangles[3 * face + k]];
    std::rotate(f.corners.begin(), std::min_element(f.corners.begin(), f.corners.end()),
                f.corners.end());
    f.was = static_cast<std::uint32_t>(face);
    faces[next[f.corners[0]]++] = f;
  }
  // Faces with the same points are adjacent, in any orientation.
  const auto isBefore = [](const Face& a, const Face& b) {
    const auto key = [](const Face& f) {
      return std::make_tuple(std::min(f.corners[1], f.corners[2]),
                             std::max(f.corners[1], f.corners[2]), f.corners[1], f.was);
    };
    return key(a) < key(b);
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 1 << 12),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t point = range.begin(); point != range.end(); ++point)
                        std::sort(faces.begin() + static_cast<std::ptrdiff_t>(firstOf[point]),
                                  faces.begin() + static_cast<std::ptrdiff_t>(firstOf[point + 1]),
                                  isBefore);
                    });
  canonical.mesh.triangles.reserve(3 * faces.size());
  canonical.faceWas.reserve(faces.size());
  for (const Face& f : faces) {
    canonical.mesh.triangles.insert(canonical.mesh.triangles.end(), f.corners.begin(),
                                    f.corners.end());
    canonical.faceWas.push_back(f.was);
  }
  canonical.mesh.faceCount = faces.size();
  return canonical;
}

} // namespace tetvdb
