// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/TriangulateLoop.h"

#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = SpaceLoop::kNone;

// The cost of the triangles of a section: 1 - cosine of the largest angle, and the area.
struct Cost {
  double bend = 0, area = 0;
  bool possible = true;
  bool operator<(const Cost& other) const {
    if (possible != other.possible)
      return possible;
    // Angles that differ by less than rounding errors are equal.
    if (bend < other.bend - 1e-9 || bend > other.bend + 1e-9)
      return bend < other.bend;
    return area < other.area;
  }
};

Vec3d unitNormal(const Vec3d& a, const Vec3d& b, const Vec3d& c, double& area) {
  const Vec3d n = cross(minus(b, a), minus(c, a));
  const double size = length(n);
  area = size / 2;
  return size > 0 ? times(n, 1 / size) : Vec3d{0, 0, 0};
}

class LoopCosts {
public:
  LoopCosts(const std::vector<Vec3d>& points, const SpaceLoop& loop, const EdgeTaken& isTaken)
      : points_(points), loop_(loop), isTaken_(isTaken), n_(loop.points.size()), costs_(n_ * n_),
        midpoint_(n_ * n_, 0) {}

  bool run(std::vector<std::uint32_t>& corners, Progress& progress) {
    for (std::size_t span = 2; span < n_; ++span) {
      progress.check();
      for (std::size_t i = 0; i + span < n_; ++i)
        solve(i, i + span);
    }
    if (!costs_[n_ - 1].possible)
      return false;
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, n_ - 1}};
    while (!open.empty()) {
      const auto [i, k] = open.back();
      open.pop_back();
      if (k - i < 2)
        continue;
      const std::size_t j = midpoint_[i * n_ + k];
      for (const std::size_t corner : {i, j, k})
        corners.push_back(loop_.points[corner]);
      open.emplace_back(j, k);
      open.emplace_back(i, j);
    }
    return true;
  }

private:
  const Vec3d& at(std::size_t i) const { return points_[loop_.points[i]]; }

  // Normal of the face beyond the edge or chord from i to k.
  bool normalBeyond(std::size_t i, std::size_t k, Vec3d& normal) const {
    double area;
    if (k - i > 1) {
      normal = unitNormal(at(i), at(midpoint_[i * n_ + k]), at(k), area);
      return true;
    }
    const std::uint32_t beyond = loop_.beyond[i];
    if (beyond == kNone)
      return false;
    normal = unitNormal(at(k), at(i), points_[beyond], area);
    return true;
  }

  void solve(std::size_t i, std::size_t k) {
    Cost best;
    best.possible = false;
    const bool closing = i == 0 && k == n_ - 1; // its chord is the loop's last edge
    std::size_t midpoint = i + 1;
    if (closing || !isTaken_(loop_.points[i], loop_.points[k])) {
      for (std::size_t j = i + 1; j < k; ++j) {
        const Cost &left = costs_[i * n_ + j], &right = costs_[j * n_ + k];
        if (!left.possible || !right.possible)
          continue;
        Cost cost;
        const Vec3d normal = unitNormal(at(i), at(j), at(k), cost.area);
        cost.bend = std::max(left.bend, right.bend);
        if (cost.area == 0)
          cost.bend = 2;
        Vec3d beyond;
        if (normalBeyond(i, j, beyond))
          cost.bend = std::max(cost.bend, 1 - dot(normal, beyond));
        if (normalBeyond(j, k, beyond))
          cost.bend = std::max(cost.bend, 1 - dot(normal, beyond));
        if (closing && loop_.beyond[k] != kNone) {
          double area;
          beyond = unitNormal(at(i), at(k), points_[loop_.beyond[k]], area);
          cost.bend = std::max(cost.bend, 1 - dot(normal, beyond));
        }
        cost.area += left.area + right.area;
        if (cost < best) {
          best = cost;
          midpoint = j;
        }
      }
    }
    costs_[i * n_ + k] = best;
    midpoint_[i * n_ + k] = static_cast<std::uint32_t>(midpoint);
  }

  const std::vector<Vec3d>& points_;
  const SpaceLoop& loop_;
  const EdgeTaken& isTaken_;
  const std::size_t n_;
  std::vector<Cost> costs_; ///< of the section from i to k: [n i + k]
  std::vector<std::uint32_t> midpoint_;
};

// Splits a loop along its shortest free chord between points that are far apart on it.
std::pair<SpaceLoop, SpaceLoop> cutAlongChord(const std::vector<Vec3d>& points,
                                              const SpaceLoop& loop, const EdgeTaken& isTaken) {
  const std::size_t n = loop.points.size(), min = n / 4;
  std::size_t first = 0, second = n / 2;
  double shortest = -1;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + min; j < n && j <= i + n - min; ++j) {
      const double chord = length(minus(points[loop.points[i]], points[loop.points[j]]));
      if ((shortest < 0 || chord < shortest) && !isTaken(loop.points[i], loop.points[j])) {
        shortest = chord;
        first = i;
        second = j;
      }
    }
  const auto part = [&](std::size_t from, std::size_t count) {
    SpaceLoop half;
    for (std::size_t i = 0; i <= count; ++i) {
      half.points.push_back(loop.points[(from + i) % n]);
      half.beyond.push_back(i < count ? loop.beyond[(from + i) % n] : kNone);
    }
    return half;
  };
  return {part(first, second - first), part(second, n - (second - first))};
}

} // namespace

bool triangulateLoop(const std::vector<Vec3d>& points, const SpaceLoop& loop,
                     const EdgeTaken& isTaken, std::vector<std::uint32_t>& corners,
                     Progress& progress) {
  if (loop.points.size() < 3)
    return false;
  std::vector<std::uint32_t> made;
  std::vector<SpaceLoop> open{loop};
  while (!open.empty()) {
    const SpaceLoop part = std::move(open.back());
    open.pop_back();
    if (part.points.size() > kMaxLoopPoints) {
      auto halves = cutAlongChord(points, part, isTaken);
      open.push_back(std::move(halves.second));
      open.push_back(std::move(halves.first));
    } else if (!LoopCosts(points, part, isTaken).run(made, progress)) {
      return false;
    }
  }
  corners.insert(corners.end(), made.begin(), made.end());
  return true;
}

} // namespace tetvdb
