// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/CornerNormals.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/WeldPoints.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

constexpr float kWhole = 32767;

float signOf(float x) {
  return x < 0 ? -1.0F : 1.0F;
}

// Of length 1, or zero for a face without area.
Vec3d faceNormal(const TriangleMesh& mesh, std::size_t face) {
  const Vec3d& a = mesh.points[mesh.triangles[3 * face]];
  const Vec3d n = cross(minus(mesh.points[mesh.triangles[3 * face + 1]], a),
                        minus(mesh.points[mesh.triangles[3 * face + 2]], a));
  const double size = length(n);
  return size > 0 && std::isfinite(1 / size) ? times(n, 1 / size) : Vec3d{0, 0, 0};
}

double angleAt(const TriangleMesh& mesh, std::size_t side) {
  const std::size_t first = side - side % 3;
  const Vec3d& p = mesh.points[mesh.triangles[side]];
  const Vec3d u = minus(mesh.points[mesh.triangles[first + (side + 1) % 3]], p);
  const Vec3d v = minus(mesh.points[mesh.triangles[first + (side + 2) % 3]], p);
  return std::atan2(length(cross(u, v)), dot(u, v));
}

} // namespace

PackedNormal packNormal(const std::array<float, 3>& normal) {
  const float sum = std::abs(normal[0]) + std::abs(normal[1]) + std::abs(normal[2]);
  if (!(sum > 0))
    return {0, 0};
  float x = normal[0] / sum, y = normal[1] / sum;
  if (normal[2] < 0) { // the lower half is folded outward
    const float folded = (1 - std::abs(y)) * signOf(x);
    y = (1 - std::abs(x)) * signOf(y);
    x = folded;
  }
  return {static_cast<std::int16_t>(std::lround(x * kWhole)),
          static_cast<std::int16_t>(std::lround(y * kWhole))};
}

std::array<float, 3> unpackNormal(const PackedNormal& packed) {
  float x = static_cast<float>(packed[0]) / kWhole, y = static_cast<float>(packed[1]) / kWhole;
  const float z = 1 - std::abs(x) - std::abs(y);
  if (z < 0) {
    const float unfolded = (1 - std::abs(y)) * signOf(x);
    y = (1 - std::abs(x)) * signOf(y);
    x = unfolded;
  }
  const float size = std::sqrt(x * x + y * y + z * z);
  return {x / size, y / size, z / size};
}

std::vector<PackedNormal> cornerNormals(const TriangleMesh& mesh, double creaseDegrees,
                                        Progress& progress) {
  const std::vector<std::uint32_t> welded = weldPoints(mesh.points, 0, progress);
  progress.check();
  // Directed edges by their first point.
  std::vector<std::uint32_t> first(mesh.points.size() + 1, 0), sides(mesh.triangles.size());
  for (const std::uint32_t v : mesh.triangles)
    ++first[welded[v] + 1];
  for (std::size_t point = 1; point < first.size(); ++point)
    first[point] += first[point - 1];
  {
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::size_t side = 0; side < sides.size(); ++side)
      sides[next[welded[mesh.triangles[side]]]++] = static_cast<std::uint32_t>(side);
  }
  progress.check();

  std::vector<PackedNormal> normals(mesh.triangles.size());
  const double minCosine = std::cos(creaseDegrees * kRadiansPerDegree);
  tbb::parallel_for(std::size_t(0), mesh.triangleCount(), [&](std::size_t face) {
    const Vec3d own = faceNormal(mesh, face);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t point = welded[mesh.triangles[3 * face + k]];
      Vec3d sum{0, 0, 0};
      for (std::uint32_t i = first[point]; i < first[point + 1]; ++i) {
        const Vec3d other = faceNormal(mesh, sides[i] / 3);
        if (dot(own, other) >= minCosine)
          sum = plus(sum, times(other, angleAt(mesh, sides[i])));
      }
      const double size = length(sum);
      const Vec3d n = size > 0 ? times(sum, 1 / size) : own;
      normals[3 * face + k] = packNormal(
          {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
    }
  });
  return normals;
}

} // namespace tetvdb
