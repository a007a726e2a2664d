// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/TriangleClusters.h"

#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/SplitAlongAxis.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tbb/parallel_invoke.h>
#include <tuple>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;
constexpr std::uint32_t kTrianglesATask = 8192;

// Clusters that a tree over `count` triangles has.
std::uint32_t clustersOf(std::uint32_t count) {
  if (count <= kLeafTriangles)
    return 1;
  // Halves of halves differ by one at most.
  const std::uint32_t half = count / 2, rest = count - half;
  std::map<std::uint32_t, std::uint32_t> numbers; // of how many triangles, how many clusters
  numbers[half] += 1;
  numbers[rest] += 1;
  std::uint32_t clusters = 1;
  while (!numbers.empty()) {
    const auto [n, times] = *numbers.rbegin();
    numbers.erase(n);
    clusters += times;
    if (n > kLeafTriangles) {
      numbers[n / 2] += times;
      numbers[n - n / 2] += times;
    }
  }
  return clusters;
}

double areaOf(const FillTriangle& t) {
  return length(cross(from(t.a, t.b), from(t.a, t.c))) / 2 * t.weight;
}

// A multiple of the middle.
Vec3d midpointOf(const FillTriangle& t) {
  return {t.a.x + t.b.x + t.c.x, t.a.y + t.b.y + t.c.y, t.a.z + t.b.z + t.c.z};
}

template <typename Moments>
TETVDB_INLINE void addAll(const Moments& moments, const Vec3d& centre, const double* x,
                          const double* y, const double* z, std::size_t n, double* __restrict sum) {
  for (std::size_t i = 0; i < n; ++i)
    sum[i] += moments.angle({centre[0] - x[i], centre[1] - y[i], centre[2] - z[i]});
}

TETVDB_MULTIVERSION
void addDipoles(const DipoleMoments& moments, const Vec3d& centre, const double* x, const double* y,
                const double* z, std::size_t n, double* __restrict sum) {
  addAll(moments, centre, x, y, z, n, sum);
}

} // namespace

TriangleClusters::TriangleClusters(std::vector<FillTriangle> triangles)
    : triangles_(std::move(triangles)) {
  const auto count = static_cast<std::uint32_t>(triangles_.size());
  if (count == 0)
    return;
  clusters_.resize(clustersOf(count));
  build(0, 0, count);
  areas_.reserve(count);
  for (const FillTriangle& t : triangles_)
    areas_.push_back(areaOf(t));
}

void TriangleClusters::build(std::uint32_t index, std::uint32_t begin, std::uint32_t end) {
  Cluster& cluster = clusters_[index];
  cluster.begin = begin;
  cluster.end = end;
  cluster.second = 0;
  if (end - begin > kLeafTriangles) {
    FillTriangle* const first = triangles_.data() + begin;
    FillTriangle* const last = triangles_.data() + end;
    const std::uint32_t half = (end - begin) / 2;
    splitAlongAxis(longestAxis(first, last, midpointOf), first, first + half, last, midpointOf,
                   [](const FillTriangle& t) {
                     return std::tie(t.a.x, t.a.y, t.a.z, t.b.x, t.b.y, t.b.z, t.c.x, t.c.y, t.c.z,
                                     t.weight);
                   });
    cluster.second = index + 1 + clustersOf(half);
    const std::uint32_t second = cluster.second;
    const auto buildFirst = [&] { build(index + 1, begin, begin + half); };
    const auto buildSecond = [&] { build(second, begin + half, end); };
    if (end - begin > kTrianglesATask) {
      tbb::parallel_invoke(buildFirst, buildSecond);
    } else {
      buildFirst();
      buildSecond();
    }
  }
  summarize(cluster);
}

// The centre is that of the area, so that the part of the moments of first order is small.
void TriangleClusters::summarize(Cluster& cluster) const {
  const double inf = std::numeric_limits<double>::infinity();
  cluster.low = {inf, inf, inf};
  cluster.high = {-inf, -inf, -inf};
  cluster.area = 0;
  const LatticePoint origin = triangles_[cluster.begin].a;
  Vec3d sum{0, 0, 0};
  for (std::uint32_t i = cluster.begin; i != cluster.end; ++i) {
    const FillTriangle& t = triangles_[i];
    for (const LatticePoint* p : {&t.a, &t.b, &t.c}) {
      cluster.low = {std::min(cluster.low.x, p->x), std::min(cluster.low.y, p->y),
                     std::min(cluster.low.z, p->z)};
      cluster.high = {std::max(cluster.high.x, p->x), std::max(cluster.high.y, p->y),
                      std::max(cluster.high.z, p->z)};
    }
    const double area = areaOf(t);
    cluster.area += area;
    const Vec3d midpoint = plus(plus(from(origin, t.a), from(origin, t.b)), from(origin, t.c));
    sum = plus(sum, times(midpoint, area / 3));
  }
  if (cluster.area > 0)
    cluster.centre = {origin.x + std::floor(sum[0] / cluster.area),
                      origin.y + std::floor(sum[1] / cluster.area),
                      origin.z + std::floor(sum[2] / cluster.area)};
  else
    cluster.centre = origin;
  cluster.radius = cluster.third = 0;
  cluster.moments = DipoleMoments();
  for (std::uint32_t i = cluster.begin; i != cluster.end; ++i) {
    const FillTriangle& t = triangles_[i];
    const SeenTriangle seen = seenFrom(cluster.centre, t);
    cluster.moments.add(seen.a, seen.b, seen.c, t.weight);
    // |y|^3 is convex: its mean is at most that of the corners.
    double cubes = 0;
    for (const Vec3d* y : {&seen.a, &seen.b, &seen.c}) {
      const double away = length(*y);
      cluster.radius = std::max(cluster.radius, away);
      cubes += away * away * away / 3;
    }
    cluster.third += areaOf(t) * cubes;
  }
}

void addMoments(const TriangleClusters::Cluster& cluster, const LatticePoint& p,
                const PointSums& points) {
  addDipoles(cluster.moments, from(p, cluster.centre), points.x, points.y, points.z, points.count,
             points.sum);
}

} // namespace tetvdb
