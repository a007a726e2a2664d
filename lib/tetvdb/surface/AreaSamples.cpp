// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/AreaSamples.h"

#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

// The first terms of the R2 sequence: powers of the inverse of the root of x^3 = x + 1 (Roberts,
// The Unreasonable Effectiveness of Quasirandom Sequences, 2018).
constexpr double kStepX = 0.7548776662466927, kStepY = 0.5698402909980532;

double fraction(double x) {
  return x - std::floor(x);
}

} // namespace

AreaSamples::AreaSamples(const TriangleMesh& mesh, std::size_t samples) : mesh_(mesh) {
  double sum = 0;
  areas_.reserve(mesh.triangleCount());
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const Vec3d& a = mesh.points[mesh.triangles[i]];
    const double twice = length(cross(minus(mesh.points[mesh.triangles[i + 1]], a),
                                      minus(mesh.points[mesh.triangles[i + 2]], a)));
    sum += std::isfinite(twice) ? twice : 0;
    areas_.push_back(sum);
  }
  samples_ = sum > 0 ? samples : 0;
}

AreaSamples::Sample AreaSamples::operator[](std::size_t i) const {
  const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(samples_) * areas_.back();
  const auto face = static_cast<std::size_t>(
      std::upper_bound(areas_.begin(), areas_.end() - 1, at) - areas_.begin());
  double s = fraction(static_cast<double>(i + 1) * kStepX);
  double t = fraction(static_cast<double>(i + 1) * kStepY);
  if (s + t > 1) {
    s = 1 - s;
    t = 1 - t;
  }
  const Vec3d& a = mesh_.points[mesh_.triangles[3 * face]];
  const Vec3d ab = minus(mesh_.points[mesh_.triangles[3 * face + 1]], a);
  const Vec3d ac = minus(mesh_.points[mesh_.triangles[3 * face + 2]], a);
  return {face, plus(a, plus(times(ab, s), times(ac, t)))};
}

} // namespace tetvdb
