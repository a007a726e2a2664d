// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/soup/Landmarks.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/soup/TriangleTree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetvdb {
namespace {

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

// Faces that many points are compared with.
class NearFaces {
public:
  void set(const std::vector<Landmarks::Face>& faces) {
    triangles_.clear();
    for (const auto& [a, b, c] : faces)
      triangles_.emplace_back(a, b, c, 0);
    last_ = 0;
  }
  // Whether a face is within a squared distance; most likely it is the one that was the last time.
  bool isWithin(const Vec3d& p, double limit) {
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      const std::size_t at =
          last_ + i < triangles_.size() ? last_ + i : last_ + i - triangles_.size();
      if (triangles_[at].squaredDistance(p) <= limit) {
        last_ = at;
        return true;
      }
    }
    return false;
  }
  double squareTo(const Vec3d& p) const {
    double minSquared = std::numeric_limits<double>::infinity();
    for (const NearTriangle& triangle : triangles_)
      minSquared = std::min(minSquared, triangle.squaredDistance(p));
    return minSquared;
  }

private:
  std::vector<NearTriangle> triangles_;
  std::size_t last_ = 0;
};

std::vector<Box> landmarksOf(const Envelope& surface, double radius, std::vector<Vec3d> points) {
  std::vector<EdgeOfFace> edges;
  for (const Landmarks::Face& face : surface.faces())
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d &a = face[k], &b = face[(k + 1) % 3];
      points.push_back(a);
      if (a != b)
        edges.push_back({std::min(a, b), std::max(a, b), face[(k + 2) % 3]});
    }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
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
      points.push_back(plus(from, times(edge, k / intervals)));
  }
  std::vector<Box> boxes;
  boxes.reserve(points.size());
  for (const Vec3d& p : points)
    boxes.push_back({p, p});
  return boxes;
}

} // namespace

Landmarks::Landmarks(const Envelope& surface, double radius, const std::vector<Vec3d>& more)
    : radius_(radius), points_(landmarksOf(surface, radius, more)) {}

bool Landmarks::keeps(const std::vector<Face>& before, const std::vector<Face>& after) const {
  Box near;
  for (const Face& face : before)
    for (const Vec3d& p : face)
      near.add(p);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    near.low[axis] -= radius_;
    near.high[axis] += radius_;
  }
  thread_local NearFaces old, fresh;
  old.set(before);
  fresh.set(after);
  const double most = kShare * radius_;
  // Boxes of which every point is known to be kept are not looked into.
  const auto isOpen = [&](const Box& box) {
    if (!near.meets(box))
      return false;
    const Vec3d centre = times(plus(box.low, box.high), 0.5);
    const double reach = length(minus(box.high, centre)), far = radius_ + reach;
    return reach == 0 ||
           (!(reach < most && fresh.isWithin(centre, (most - reach) * (most - reach))) &&
            old.isWithin(centre, far * far));
  };
  bool isLost = false;
  points_.visit(isOpen, [&](std::uint32_t point) {
    const Vec3d& p = points_.box(point).low;
    if (fresh.isWithin(p, most * most))
      return false;
    const double was = old.squareTo(p);
    return isLost = was <= radius_ * radius_ && !(fresh.squareTo(p) <= was);
  });
  return !isLost;
}

} // namespace tetvdb
