// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/soup/Landmarks.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetvdb {
namespace {

constexpr std::uint32_t kLeaf = 8;
// Intervals between landmarks along all edges together, which are as long as the radius or longer.
constexpr double kMaxIntervals = 500000;
// Within an envelope of radius r along an edge that turns by an angle t a surface can be as far as
// r / cos(t / 2) from the edge: at 15 degrees less than a hundredth more than r.
const double kFlat = -std::cos(15 * 3.14159265358979323846 / 180);

struct EdgeOfFace {
  Vec3d from, to, across; ///< across: the face's third point

  bool operator<(const EdgeOfFace& other) const {
    return from != other.from ? from < other.from
           : to != other.to   ? to < other.to
                              : across < other.across;
  }
};

// Whether two faces at an edge are nearly coplanar, in either orientation.
bool isFlat(const EdgeOfFace& one, const EdgeOfFace& other) {
  const Vec3d edge = minus(one.to, one.from);
  const auto out = [&](const Vec3d& p) {
    const Vec3d to = minus(p, one.from);
    return minus(to, times(edge, dot(to, edge) / dot(edge, edge)));
  };
  const Vec3d u = out(one.across), v = out(other.across);
  return dot(u, v) <= kFlat * length(u) * length(v);
}

double squareTo(const Vec3d& p, const std::vector<Landmarks::Face>& faces) {
  double minSquared = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : faces)
    minSquared =
        std::min(minSquared, nearestOnTriangle(minus(a, p), minus(b, p), minus(c, p)).squared);
  return minSquared;
}

} // namespace

Landmarks::Landmarks(const Envelope& surface, double radius, const std::vector<Vec3d>& more)
    : radius_(radius), points_(more) {
  std::vector<EdgeOfFace> edges;
  for (const Face& face : surface.faces())
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d &a = face[k], &b = face[(k + 1) % 3];
      points_.push_back(a);
      if (a != b)
        edges.push_back({std::min(a, b), std::max(a, b), face[(k + 2) % 3]});
    }
  std::sort(points_.begin(), points_.end());
  points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
  std::sort(edges.begin(), edges.end());
  double total = 0;
  std::size_t count = 0; // of edges that are not flat, one record each
  for (std::size_t i = 0, next; i < edges.size(); i = next) {
    for (next = i + 1;
         next < edges.size() && edges[next].from == edges[i].from && edges[next].to == edges[i].to;)
      ++next;
    if (next - i == 2 && isFlat(edges[i], edges[i + 1]))
      continue;
    total += length(minus(edges[i].to, edges[i].from));
    edges[count++] = edges[i];
  }
  const double spacing = std::max(radius, total / kMaxIntervals);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d from = edges[i].from, edge = minus(edges[i].to, from);
    const double intervals = std::ceil(length(edge) / spacing);
    for (double k = 1; k < intervals; ++k)
      points_.push_back(plus(from, times(edge, k / intervals)));
  }
  if (!points_.empty())
    addNode(0, static_cast<std::uint32_t>(points_.size()));
}

std::uint32_t Landmarks::addNode(std::uint32_t begin, std::uint32_t end) {
  Box box;
  for (std::uint32_t i = begin; i < end; ++i)
    box.add(points_[i]);
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({box.low, box.high, begin, end, 0});
  if (end - begin <= kLeaf)
    return number;
  std::size_t axis = 0;
  for (std::size_t other = 1; other < 3; ++other)
    if (box.high[other] - box.low[other] > box.high[axis] - box.low[axis])
      axis = other;
  const std::uint32_t median = begin + (end - begin) / 2;
  std::nth_element(points_.begin() + begin, points_.begin() + median, points_.begin() + end,
                   [axis](const Vec3d& a, const Vec3d& b) {
                     return a[axis] != b[axis] ? a[axis] < b[axis] : a < b;
                   });
  addNode(begin, median);
  const std::uint32_t second = addNode(median, end);
  nodes_[number].second = second;
  return number;
}

bool Landmarks::keeps(const std::vector<Face>& before, const std::vector<Face>& after) const {
  if (nodes_.empty())
    return true;
  Box near;
  for (const Face& face : before)
    for (const Vec3d& p : face)
      near.add(p);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    near.low[axis] -= radius_;
    near.high[axis] += radius_;
  }
  std::array<std::uint32_t, 64> stack{};
  std::size_t depth = 1;
  while (depth > 0) {
    const std::uint32_t number = stack[--depth];
    const Node& node = nodes_[number];
    if (!near.meets({node.low, node.high}))
      continue;
    if (node.second == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i)
        if (near.contains(points_[i]) && !keeps(points_[i], before, after))
          return false;
      continue;
    }
    const Vec3d centre = times(plus(node.low, node.high), 0.5);
    const double reach = length(minus(node.high, centre));
    if (std::sqrt(squareTo(centre, before)) > radius_ + reach ||
        std::sqrt(squareTo(centre, after)) + reach < kShare * radius_)
      continue;
    stack[depth++] = number + 1;
    stack[depth++] = node.second;
  }
  return true;
}

bool Landmarks::keeps(const Vec3d& p, const std::vector<Face>& before,
                      const std::vector<Face>& after) const {
  const double now = squareTo(p, after);
  if (now <= kShare * kShare * radius_ * radius_)
    return true;
  const double was = squareTo(p, before);
  return now <= was || was > radius_ * radius_;
}

} // namespace tetvdb
