// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/TriangulatePolygon.h"

#include "tetvdb/geometry/Orientation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>
#include <utility>

namespace tetvdb {
namespace {

using Loop = std::vector<std::uint32_t>;

// The points as seen along the normal's largest axis, so that coordinates stay as they are.
class FlatPoints {
public:
  FlatPoints(const std::vector<Vec3d>& points, const Vec3d& normal) : points_(points) {
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (std::abs(normal[k]) > std::abs(normal[axis]))
        axis = k;
    p_ = (axis + 1) % 3;
    q_ = (axis + 2) % 3;
    if (normal[axis] < 0)
      std::swap(p_, q_);
  }
  Vec2d at(std::uint32_t i) const { return {points_[i][p_], points_[i][q_]}; }
  int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return orientation(at(a), at(b), at(c));
  }
  bool contains(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t x) const {
    return turn(a, b, x) >= 0 && turn(b, c, x) >= 0 && turn(c, a, x) >= 0;
  }
  bool properlyCross(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
    return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
  }
  // Of the segment from a to b, without its ends.
  bool isWithin(std::uint32_t a, std::uint32_t b, std::uint32_t x) const {
    if (turn(a, b, x) != 0)
      return false;
    const Vec2d u = at(a), v = at(b), w = at(x);
    return (w[0] - u[0]) * (w[0] - v[0]) + (w[1] - u[1]) * (w[1] - v[1]) < 0;
  }
  double squaredDistance(std::uint32_t a, std::uint32_t b) const {
    const Vec2d u = at(a), v = at(b);
    return (u[0] - v[0]) * (u[0] - v[0]) + (u[1] - v[1]) * (u[1] - v[1]);
  }
  // Twice the area over the square of the longest side: 0 for a line.
  double shape(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vec2d u = at(a), v = at(b), w = at(c);
    const double area = (v[0] - u[0]) * (w[1] - u[1]) - (v[1] - u[1]) * (w[0] - u[0]);
    const double longest =
        std::max({squaredDistance(a, b), squaredDistance(b, c), squaredDistance(c, a)});
    return longest > 0 ? area / longest : 0;
  }

private:
  const std::vector<Vec3d>& points_;
  std::size_t p_ = 0, q_ = 1;
};

// The outline with every hole joined to it by an edge that is run along both ways; empty where
// there is no such edge.
Loop withBridges(const FlatPoints& flat, const std::vector<Loop>& loops) {
  Loop outline = loops.front();
  std::vector<const Loop*> holes;
  for (std::size_t i = 1; i < loops.size(); ++i)
    holes.push_back(&loops[i]);
  const auto crosses = [&](const Loop& loop, std::uint32_t a, std::uint32_t b) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::uint32_t c = loop[i], d = loop[(i + 1) % loop.size()];
      if (flat.properlyCross(a, b, c, d) || flat.isWithin(a, b, c))
        return true;
    }
    return false;
  };
  // Whether the way from place i of the outline to x leads into the polygon.
  const auto entersAt = [&](std::size_t i, std::uint32_t x) {
    const std::size_t n = outline.size();
    const std::uint32_t before = outline[(i + n - 1) % n], at = outline[i],
                        after = outline[(i + 1) % n];
    const bool left = flat.turn(before, at, x) > 0, right = flat.turn(at, after, x) > 0;
    return flat.turn(before, at, after) > 0 ? left && right : left || right;
  };
  while (!holes.empty()) {
    using Pair = std::tuple<double, std::size_t, std::size_t, std::size_t>;
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < outline.size(); ++i)
      for (std::size_t h = 0; h < holes.size(); ++h)
        for (std::size_t j = 0; j < holes[h]->size(); ++j)
          pairs.emplace_back(flat.squaredDistance(outline[i], (*holes[h])[j]), i, h, j);
    std::sort(pairs.begin(), pairs.end());
    bool found = false;
    for (const auto& [distance, i, h, j] : pairs) {
      const Loop& hole = *holes[h];
      const std::uint32_t from = outline[i], to = hole[j];
      if (!entersAt(i, to) || crosses(outline, from, to) ||
          std::any_of(holes.begin(), holes.end(),
                      [&](const Loop* other) { return crosses(*other, from, to); }))
        continue;
      Loop detour(hole.begin() + static_cast<std::ptrdiff_t>(j), hole.end());
      detour.insert(detour.end(), hole.begin(), hole.begin() + static_cast<std::ptrdiff_t>(j) + 1);
      detour.push_back(from);
      outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(i) + 1, detour.begin(),
                     detour.end());
      holes.erase(holes.begin() + static_cast<std::ptrdiff_t>(h));
      found = true;
      break;
    }
    if (!found)
      return {};
  }
  return outline;
}

class EarClipping {
public:
  EarClipping(const FlatPoints& flat, Loop outline, const EdgeTaken& isTaken)
      : flat_(flat), left_(std::move(outline)), isTaken_(isTaken) {}

  bool run(std::vector<std::uint32_t>& corners) {
    shapes_.assign(left_.size(), kUnknown);
    while (left_.size() > 3) {
      std::size_t best = bestEar();
      if (best == left_.size()) { // what stood in an ear may have been clipped
        std::fill(shapes_.begin(), shapes_.end(), kUnknown);
        best = bestEar();
      }
      if (best == left_.size()) {
        if (takenAllowed_)
          return false;
        takenAllowed_ = true;
        std::fill(shapes_.begin(), shapes_.end(), kUnknown);
        continue;
      }
      add(corners, best);
      const auto at = static_cast<std::ptrdiff_t>(best);
      left_.erase(left_.begin() + at);
      shapes_.erase(shapes_.begin() + at);
      shapes_[best % left_.size()] = shapes_[(best + left_.size() - 1) % left_.size()] = kUnknown;
    }
    if (flat_.turn(left_[0], left_[1], left_[2]) <= 0)
      return false;
    add(corners, 1);
    return true;
  }

private:
  static constexpr double kUnknown = -1; // 0: no ear

  std::uint32_t at(std::size_t i) const { return left_[i % left_.size()]; }
  void add(std::vector<std::uint32_t>& corners, std::size_t i) const {
    for (const std::size_t k : {i + left_.size() - 1, i, i + 1})
      corners.push_back(at(k));
  }

  std::size_t bestEar() {
    std::size_t best = left_.size();
    for (std::size_t i = 0; i < left_.size(); ++i) {
      if (shapes_[i] == kUnknown)
        shapes_[i] = earShape(i);
      if (shapes_[i] > 0 && (best == left_.size() || shapes_[i] > shapes_[best]))
        best = i;
    }
    return best;
  }

  double earShape(std::size_t i) const {
    const std::size_t n = left_.size();
    const std::uint32_t a = at(i + n - 1), b = at(i), c = at(i + 1);
    if (a == c || flat_.turn(a, b, c) <= 0 || (!takenAllowed_ && isTaken_(a, c)))
      return 0;
    for (std::size_t k = 0; k < n; ++k) {
      const std::uint32_t x = left_[k], y = at(k + 1);
      if (x != a && x != b && x != c && flat_.contains(a, b, c, x))
        return 0;
      if (flat_.properlyCross(a, c, x, y))
        return 0;
    }
    return std::max(flat_.shape(a, b, c), 1e-300);
  }

  const FlatPoints& flat_;
  Loop left_;
  const EdgeTaken& isTaken_;
  std::vector<double> shapes_; ///< by place: of the ear there
  bool takenAllowed_ = false;
};

// Flips inner edges while that makes the worse of the two triangles better.
void flipEdges(const FlatPoints& flat, const EdgeTaken& isTaken,
               std::vector<std::uint32_t>& corners) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  constexpr int kMostRounds = 16;
  for (int round = 0; round < kMostRounds; ++round) {
    std::map<Edge, std::size_t> sides; // directed; two where a bridge's edge is run along twice
    for (std::size_t s = 0; s < corners.size(); ++s)
      sides[{corners[s], corners[s % 3 == 2 ? s - 2 : s + 1]}] = s;
    std::vector<char> touched(corners.size() / 3, 0);
    bool flipped = false;
    for (const auto& [edge, side] : sides) {
      const auto [a, b] = edge;
      const auto back = sides.find({b, a});
      if (a > b || back == sides.end() || touched[side / 3] != 0 || touched[back->second / 3] != 0)
        continue;
      const std::size_t f = side / 3, g = back->second / 3;
      const std::uint32_t c = corners[3 * f + (side + 2) % 3],
                          d = corners[3 * g + (back->second + 2) % 3];
      if (c == d || flat.turn(a, d, c) <= 0 || flat.turn(d, b, c) <= 0 || isTaken(c, d) ||
          sides.count({c, d}) + sides.count({d, c}) > 0)
        continue;
      const double now = std::min(flat.shape(a, b, c), flat.shape(b, a, d));
      const double then = std::min(flat.shape(a, d, c), flat.shape(d, b, c));
      if (!(then > now * (1 + 1e-9)))
        continue;
      const std::array<std::uint32_t, 3> first{a, d, c}, second{d, b, c};
      std::copy(first.begin(), first.end(), &corners[3 * f]);
      std::copy(second.begin(), second.end(), &corners[3 * g]);
      touched[f] = touched[g] = 1;
      flipped = true;
    }
    if (!flipped)
      return;
  }
}

} // namespace

bool triangulatePolygon(const std::vector<Vec3d>& points,
                        const std::vector<std::vector<std::uint32_t>>& loops, const Vec3d& normal,
                        const EdgeTaken& isTaken, std::vector<std::uint32_t>& corners) {
  const FlatPoints flat(points, normal);
  Loop outline = withBridges(flat, loops);
  if (outline.size() < 3)
    return false;
  std::vector<std::uint32_t> made;
  if (!EarClipping(flat, std::move(outline), isTaken).run(made))
    return false;
  flipEdges(flat, isTaken, made);
  corners.insert(corners.end(), made.begin(), made.end());
  return true;
}

} // namespace tetvdb
