// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/mesh/TetStatistics.h"

#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace tetvdb {
namespace {

constexpr std::size_t kTetsPerTask = 1 << 14;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Relative rounding error of the determinant below, generously.
constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();

double largest(const Vec3d& v) {
  return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
}

double determinant(const Vec3d& u, const Vec3d& v, const Vec3d& w) {
  return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) +
         u[2] * (v[0] * w[1] - v[1] * w[0]);
}

struct Sum {
  TetStatistics total;

  void add(const TetMesh& mesh, std::size_t tet) {
    const std::uint32_t* corner = &mesh.tets[4 * tet];
    double boxVolume = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto [low, high] =
          std::minmax({mesh.points[corner[0]][axis], mesh.points[corner[1]][axis],
                       mesh.points[corner[2]][axis], mesh.points[corner[3]][axis]});
      total.boxMin[axis] = std::min(total.boxMin[axis], low);
      total.boxMax[axis] = std::max(total.boxMax[axis], high);
      boxVolume *= high - low;
    }
    total.boxVolume += boxVolume;
    const Vec3d& origin = mesh.points[corner[0]];
    const Vec3d u = minus(mesh.points[corner[1]], origin);
    const Vec3d v = minus(mesh.points[corner[2]], origin);
    const Vec3d w = minus(mesh.points[corner[3]], origin);
    const double sixfold = determinant(u, v, w);
    const double error = kRounding * largest(u) * largest(v) * largest(w);
    if (std::abs(sixfold) <= error)
      ++total.flat;
    else if (sixfold < 0)
      ++total.inverted;
    total.volume += std::abs(sixfold) / 6;
  }

  void join(const Sum& other) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      total.boxMin[axis] = std::min(total.boxMin[axis], other.total.boxMin[axis]);
      total.boxMax[axis] = std::max(total.boxMax[axis], other.total.boxMax[axis]);
    }
    total.volume += other.total.volume;
    total.boxVolume += other.total.boxVolume;
    total.inverted += other.total.inverted;
    total.flat += other.total.flat;
  }
};

} // namespace

TetStatistics measure(const TetMesh& mesh) {
  if (mesh.tetCount() == 0)
    return {};
  Sum none;
  none.total.boxMin = {kInfinity, kInfinity, kInfinity};
  none.total.boxMax = {-kInfinity, -kInfinity, -kInfinity};
  return tbb::parallel_deterministic_reduce(
             tbb::blocked_range<std::size_t>(0, mesh.tetCount(), kTetsPerTask), none,
             [&](const tbb::blocked_range<std::size_t>& range, Sum sum) {
               for (std::size_t tet = range.begin(); tet != range.end(); ++tet)
                 sum.add(mesh, tet);
               return sum;
             },
             [](Sum left, const Sum& right) {
               left.join(right);
               return left;
             })
      .total;
}

} // namespace tetvdb
