// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/soup/SurfaceSamples.h"

#include "tetvdb/geometry/VectorMath.h"

#include <cmath>

namespace tetvdb {
namespace {

// Multiples of 1/g, 1/g^2, 1/g^3 with g^4 = g + 1 are evenly spread in three dimensions, modulo 1
// (M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018).
constexpr double kSteps[3] = {0.8191725133961644, 0.6710436067037892, 0.5497004779019702};

double sequence(std::size_t axis, std::size_t i) {
  const double at = 0.5 + kSteps[axis] * static_cast<double>(i + 1);
  return at - std::floor(at);
}

} // namespace

std::vector<SurfaceSample> sampleSurface(const TriangleMesh& mesh, std::size_t count,
                                         bool centroids) {
  const auto corner = [&](std::size_t triangle, std::size_t k) -> const Vec3d& {
    return mesh.points[mesh.triangles[3 * triangle + k]];
  };
  std::vector<double> areas(mesh.triangleCount());
  double total = 0;
  for (std::size_t t = 0; t < areas.size(); ++t) {
    areas[t] = length(cross(minus(corner(t, 1), corner(t, 0)), minus(corner(t, 2), corner(t, 0))));
    total += areas[t];
  }
  std::vector<SurfaceSample> samples;
  if (!(total > 0))
    return samples;
  const double stretch = total / static_cast<double>(count);
  double before = 0;
  std::size_t next = 0;
  const auto place = [&](std::size_t i) {
    return stretch * (static_cast<double>(i) + sequence(0, i));
  };
  for (std::uint32_t t = 0; t < areas.size(); ++t) {
    before += areas[t];
    for (; next < count && place(next) < before; ++next) {
      // Uniform over the triangle, by the square root (Osada et al., Shape Distributions, 2002).
      const double root = std::sqrt(sequence(1, next)), across = sequence(2, next);
      samples.push_back(
          {plus(plus(times(corner(t, 0), 1 - root), times(corner(t, 1), root * (1 - across))),
                times(corner(t, 2), root * across)),
           t});
    }
    if (centroids && areas[t] > 0)
      samples.push_back({times(plus(plus(corner(t, 0), corner(t, 1)), corner(t, 2)), 1.0 / 3), t});
  }
  return samples;
}

Vec3d pointInBox(const Box& box, std::size_t i) {
  Vec3d p;
  for (std::size_t axis = 0; axis < 3; ++axis)
    p[axis] = box.low[axis] + (box.high[axis] - box.low[axis]) * sequence(axis, i);
  return p;
}

} // namespace tetvdb
