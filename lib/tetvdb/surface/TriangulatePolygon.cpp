// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/TriangulatePolygon.h"

#include "tetvdb/geometry/Orientation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

namespace tetvdb {
namespace {

// The points projected along the normal's largest axis, so that coordinates do not change.
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
  bool properlyCross(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
    return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
  }
  double squaredDistance(std::uint32_t a, std::uint32_t b) const {
    const Vec2d u = at(a), v = at(b);
    return (u[0] - v[0]) * (u[0] - v[0]) + (u[1] - v[1]) * (u[1] - v[1]);
  }
  // Twice the area over the squared longest side: 0 for a line.
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

// A triangulation of the convex hull of points with constrained edges.
class ConstrainedTriangles {
public:
  explicit ConstrainedTriangles(const FlatPoints& flat) : flat_(flat) {}

  // Adds all points in the order of their positions: each is connected to the visible edges of the
  // hull. Returns false if all points are collinear, or two are equal.
  bool build(std::vector<std::uint32_t> points) {
    std::sort(points.begin(), points.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::make_pair(flat_.at(a), a) < std::make_pair(flat_.at(b), b);
    });
    for (std::size_t i = 0; i + 1 < points.size(); ++i)
      if (flat_.at(points[i]) == flat_.at(points[i + 1]))
        return false;
    std::size_t apex = 2;
    while (apex < points.size() && flat_.turn(points[0], points[1], points[apex]) == 0)
      ++apex;
    if (apex >= points.size())
      return false;
    std::map<std::uint32_t, std::uint32_t> next, previous; // around the hull
    const auto link = [&](std::uint32_t a, std::uint32_t b) {
      next[a] = b;
      previous[b] = a;
    };
    const bool left = flat_.turn(points[0], points[1], points[apex]) > 0;
    for (std::size_t i = 0; i + 1 < apex; ++i) {
      const std::uint32_t a = points[left ? i : i + 1], b = points[left ? i + 1 : i];
      add(a, b, points[apex]);
      link(a, b);
    }
    link(points[left ? apex - 1 : 0], points[apex]);
    link(points[apex], points[left ? 0 : apex - 1]);
    for (std::size_t i = apex + 1; i < points.size(); ++i) {
      const std::uint32_t p = points[i];
      std::uint32_t first = points[i - 1], last = first; // the section of the hull visible from p
      while (flat_.turn(last, next[last], p) < 0) {
        add(next[last], last, p);
        last = next[last];
      }
      while (flat_.turn(previous[first], first, p) < 0) {
        add(first, previous[first], p);
        first = previous[first];
      }
      link(first, p);
      link(p, last);
    }
    return true;
  }

  // Makes a and b neighbours by flipping the edges between them. Returns false if a point or a
  // constrained edge lies between them.
  bool constrain(std::uint32_t a, std::uint32_t b) {
    if (!has(a, b) && !has(b, a) && !openWay(a, b))
      return false;
    constrained_.insert({std::min(a, b), std::max(a, b)});
    return true;
  }

  // Collects the triangles with a winding number above 0 of directed constrained edges, which are
  // counted. Returns false if there is none, if the edges are not closed, or if overlaps are
  // refused and a winding number is neither 0 nor 1.
  bool collect(const std::map<PolygonEdge, int>& edges, Overlaps overlaps,
               std::vector<std::uint32_t>& corners) const {
    const auto countOf = [&](std::uint32_t a, std::uint32_t b) {
      const auto found = edges.find({a, b});
      return found == edges.end() ? 0 : found->second;
    };
    std::vector<std::optional<int>> windings(corners_.size() / 3);
    std::vector<std::size_t> open;
    bool closed = true;
    const auto reach = [&](std::size_t triangle, int winding) {
      if (!windings[triangle])
        open.push_back(triangle);
      closed = closed && windings[triangle].value_or(winding) == winding;
      windings[triangle] = winding;
    };
    const auto across = [&](std::size_t side) {
      return sides_.find(key(corners_[nextOf(side)], corners_[side]));
    };
    const auto rise = [&](std::size_t side) { // from the right of the side to its left
      const std::uint32_t a = corners_[side], b = corners_[nextOf(side)];
      return countOf(a, b) - countOf(b, a);
    };
    for (std::size_t side = 0; side < corners_.size(); ++side)
      if (across(side) == sides_.end())
        reach(side / 3, rise(side));
    while (!open.empty()) {
      const std::size_t triangle = open.back();
      open.pop_back();
      for (std::size_t side = 3 * triangle; side < 3 * triangle + 3; ++side)
        if (const auto other = across(side); other != sides_.end())
          reach(other->second / 3, *windings[triangle] - rise(side));
    }
    std::vector<std::uint32_t> inside;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const int winding = *windings[i / 3];
      if (overlaps == Overlaps::Refused && (winding < 0 || winding > 1))
        return false;
      if (winding > 0)
        inside.push_back(corners_[i]);
    }
    corners.insert(corners.end(), inside.begin(), inside.end());
    return closed && !inside.empty();
  }

private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) { return std::uint64_t(a) << 32 | b; }
  static std::size_t nextOf(std::size_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
  bool has(std::uint32_t a, std::uint32_t b) const { return sides_.count(key(a, b)) > 0; }
  // Of the triangle to the left of the segment from a to b.
  std::uint32_t apexOf(std::uint32_t a, std::uint32_t b) const {
    return corners_[nextOf(nextOf(sides_.at(key(a, b))))];
  }

  void put(std::size_t triangle, const std::array<std::uint32_t, 3>& corners) {
    for (std::size_t k = 0; k < 3; ++k) {
      corners_[3 * triangle + k] = corners[k];
      sides_[key(corners[k], corners[(k + 1) % 3])] = 3 * triangle + k;
      sideAt_[corners[k]] = 3 * triangle + k;
    }
  }
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    corners_.resize(corners_.size() + 3);
    put(corners_.size() / 3 - 1, {a, b, c});
  }

  // The side opposite to a through which the segment to b leaves, from right to left; false if the
  // segment runs along an edge.
  bool firstCrossed(std::uint32_t a, std::uint32_t b, PolygonEdge& crossed) const {
    const std::size_t first = sideAt_.at(a);
    for (const bool forward : {true, false}) {
      std::size_t side = first; // from a
      while (true) {
        const std::uint32_t x = corners_[nextOf(side)], y = corners_[nextOf(nextOf(side))];
        if (flat_.turn(a, b, x) < 0 && flat_.turn(a, b, y) > 0 && flat_.turn(x, y, b) <= 0) {
          crossed = {x, y};
          return true;
        }
        const auto across = sides_.find(forward ? key(a, y) : key(x, a));
        if (across == sides_.end())
          break;
        side = forward ? across->second : nextOf(across->second);
        if (side == first)
          return false;
      }
    }
    return false;
  }

  bool openWay(std::uint32_t a, std::uint32_t b) {
    std::deque<PolygonEdge> crossed;
    PolygonEdge edge;
    if (!firstCrossed(a, b, edge))
      return false;
    while (true) {
      const auto [x, y] = edge; // x to the right, y to the left
      if (constrained_.count({std::min(x, y), std::max(x, y)}) > 0 || !has(y, x))
        return false;
      crossed.push_back(edge);
      const std::uint32_t ahead = apexOf(y, x);
      if (ahead == b)
        break;
      const int turn = flat_.turn(a, b, ahead);
      if (turn == 0)
        return false;
      edge = turn > 0 ? PolygonEdge{x, ahead} : PolygonEdge{ahead, y};
    }
    // Each flip of a convex pair that then does not cross the segment is final (Sloan 1993).
    std::size_t left = 64 + 16 * crossed.size() * crossed.size();
    while (!crossed.empty()) {
      if (left-- == 0)
        return false;
      const auto [x, y] = crossed.front();
      crossed.pop_front();
      const std::size_t f = sides_.at(key(x, y)) / 3, g = sides_.at(key(y, x)) / 3;
      const std::uint32_t c = apexOf(x, y), d = apexOf(y, x);
      if (!flat_.properlyCross(x, y, c, d)) {
        crossed.emplace_back(x, y);
        continue;
      }
      sides_.erase(key(x, y));
      sides_.erase(key(y, x));
      put(f, {x, d, c});
      put(g, {d, y, c});
      if (flat_.properlyCross(a, b, c, d))
        crossed.emplace_back(c, d);
    }
    return has(a, b) || has(b, a);
  }

  const FlatPoints& flat_;
  std::vector<std::uint32_t> corners_;
  std::unordered_map<std::uint64_t, std::size_t> sides_;  ///< by the two points of the side
  std::unordered_map<std::uint32_t, std::size_t> sideAt_; ///< by point: a side from it
  std::set<PolygonEdge> constrained_;                     ///< low point first
};

// Flips inner edges if this removes a taken edge, or improves the worse of the two
// triangles.
void flipEdges(const FlatPoints& flat, const EdgeTaken& isTaken,
               std::vector<std::uint32_t>& corners) {
  constexpr int kMaxRounds = 64;
  for (int round = 0; round < kMaxRounds; ++round) {
    std::map<PolygonEdge, std::size_t> sides; // directed
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
      if (!(then > now * (1 + 1e-9)) && !isTaken(a, b))
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

bool triangulateEdges(const std::vector<Vec3d>& points, const std::vector<PolygonEdge>& edges,
                      const std::vector<std::uint32_t>& inner, const Vec3d& normal,
                      const EdgeTaken& isTaken, Overlaps overlaps,
                      std::vector<std::uint32_t>& corners) {
  const FlatPoints flat(points, normal);
  std::map<PolygonEdge, int> counts;
  std::vector<std::uint32_t> used = inner;
  for (const PolygonEdge& edge : edges) {
    ++counts[edge];
    used.push_back(edge.first);
    used.push_back(edge.second);
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  ConstrainedTriangles triangles(flat);
  if (used.size() < 3 || !triangles.build(std::move(used)))
    return false;
  for (const auto& [edge, count] : counts)
    if (!triangles.constrain(edge.first, edge.second))
      return false;
  std::vector<std::uint32_t> made;
  if (!triangles.collect(counts, overlaps, made))
    return false;
  flipEdges(flat, isTaken, made);
  corners.insert(corners.end(), made.begin(), made.end());
  return true;
}

bool triangulatePolygon(const std::vector<Vec3d>& points,
                        const std::vector<std::vector<std::uint32_t>>& loops, const Vec3d& normal,
                        const EdgeTaken& isTaken, std::vector<std::uint32_t>& corners) {
  std::vector<PolygonEdge> edges;
  for (const std::vector<std::uint32_t>& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i)
      edges.emplace_back(loop[i], loop[(i + 1) % loop.size()]);
  return triangulateEdges(points, edges, {}, normal, isTaken, Overlaps::Refused, corners);
}

} // namespace tetvdb
