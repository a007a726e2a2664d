// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/dataset/SamplePoints.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/FeatureEdges.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tetvdb {
namespace {

// The entry of ascending sums within which `at` falls.
std::size_t entryOf(const std::vector<double>& sums, double at) {
  const auto found = std::upper_bound(sums.begin(), sums.end(), at);
  return std::min(static_cast<std::size_t>(found - sums.begin()), sums.size() - 1);
}

} // namespace

double RandomNumbers::normal() {
  const double radius = std::sqrt(-2 * std::log(1 - uniform()));
  return radius * std::cos(2 * kPi * uniform());
}

Vec3d RandomNumbers::direction() {
  const double z = 2 * uniform() - 1, angle = 2 * kPi * uniform();
  const double radius = std::sqrt(std::max(0.0, 1 - z * z));
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

SurfacePoints sampleSurface(const TriangleMesh& mesh, std::size_t count, RandomNumbers& random) {
  std::vector<double> sums;
  std::vector<std::size_t> faces;
  double area = 0;
  const auto cornersOf = [&](std::size_t face) {
    const std::uint32_t* c = &mesh.triangles[3 * face];
    return std::array<Vec3d, 3>{mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]]};
  };
  const auto normalOf = [&](std::size_t face) {
    const std::array<Vec3d, 3> c = cornersOf(face);
    return cross(minus(c[1], c[0]), minus(c[2], c[0]));
  };
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face) {
    const double twice = length(normalOf(face));
    if (!(twice > 0))
      continue;
    sums.push_back(area += twice);
    faces.push_back(face);
  }
  SurfacePoints samples;
  if (!(area > 0) || !std::isfinite(area))
    return samples;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t face = faces[entryOf(sums, random.uniform() * area)];
    // Osada et al., Shape Distributions, 2002.
    const double r = std::sqrt(random.uniform()), s = random.uniform();
    const std::array<Vec3d, 3> c = cornersOf(face);
    samples.points.push_back(
        plus(times(c[0], 1 - r), plus(times(c[1], r * (1 - s)), times(c[2], r * s))));
    const Vec3d normal = normalOf(face);
    samples.normals.push_back(times(normal, 1 / length(normal)));
  }
  return samples;
}

std::vector<Vec3d> sampleFeatureEdges(const TriangleMesh& mesh, double degrees, std::size_t count,
                                      RandomNumbers& random) {
  const std::vector<VertexPair> edges = featureEdges(mesh, degrees);
  std::vector<double> sums;
  sums.reserve(edges.size());
  double sum = 0;
  for (const VertexPair& edge : edges)
    sums.push_back(sum += length(minus(mesh.points[edge[1]], mesh.points[edge[0]])));
  std::vector<Vec3d> points;
  if (!(sum > 0) || !std::isfinite(sum))
    return points;
  for (std::size_t i = 0; i < count; ++i) {
    const VertexPair& edge = edges[entryOf(sums, random.uniform() * sum)];
    const double t = random.uniform();
    points.push_back(plus(times(mesh.points[edge[0]], 1 - t), times(mesh.points[edge[1]], t)));
  }
  return points;
}

void scatter(std::vector<Vec3d>& points, double deviation, RandomNumbers& random) {
  for (Vec3d& point : points)
    for (double& coordinate : point)
      coordinate += deviation * random.normal();
}

} // namespace tetvdb
