// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CanonicalOrder.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tuple>

namespace tetvdb {

CanonicalOrder canonicalOrder(const TriangleMesh& mesh) {
  CanonicalOrder canonical;
  std::vector<std::uint32_t> pointWas(mesh.points.size());
  std::iota(pointWas.begin(), pointWas.end(), 0u);
  tbb::parallel_sort(pointWas.begin(), pointWas.end(), [&](std::uint32_t a, std::uint32_t b) {
    return mesh.points[a] < mesh.points[b];
  });
  std::vector<std::uint32_t> rank(mesh.points.size());
  canonical.mesh.points.resize(mesh.points.size());
  for (std::uint32_t i = 0; i < pointWas.size(); ++i) {
    rank[pointWas[i]] = i;
    for (std::size_t axis = 0; axis < 3; ++axis) // -0 becomes 0
      canonical.mesh.points[i][axis] = mesh.points[pointWas[i]][axis] + 0.0;
  }

  struct Face {
    std::array<std::uint32_t, 3> corners;
    std::uint32_t was;
  };
  std::vector<Face> faces(mesh.triangleCount());
  tbb::parallel_for(std::size_t(0), faces.size(), [&](std::size_t face) {
    Face& f = faces[face];
    for (std::size_t k = 0; k < 3; ++k)
      f.corners[k] = rank[mesh.triangles[3 * face + k]];
    std::rotate(f.corners.begin(), std::min_element(f.corners.begin(), f.corners.end()),
                f.corners.end());
    f.was = static_cast<std::uint32_t>(face);
  });
  // Faces over the same points lie side by side, whatever way they look.
  tbb::parallel_sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    const auto key = [](const Face& f) {
      return std::make_tuple(f.corners[0], std::min(f.corners[1], f.corners[2]),
                             std::max(f.corners[1], f.corners[2]), f.corners[1], f.was);
    };
    return key(a) < key(b);
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
