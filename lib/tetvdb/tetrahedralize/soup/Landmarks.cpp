// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/soup/Landmarks.h"

#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/tetrahedralize/soup/TriangleTree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tbb/parallel_sort.h>

namespace tetvdb {
namespace {

// Intervals between landmarks along all edges together, which are as long as the radius or longer.
constexpr double kMaxIntervals = 500000;
// Within an envelope of radius r along an edge that turns by an angle t a surface can be as far as
// r / cos(t / 2) from the edge: at 15 degrees less than a hundredth more than r.
const double kFlat = -std::cos(15 * 3.14159265358979323846 / 180);

// Whether two faces at an edge, with these third points, are nearly coplanar, in either
// orientation.
bool isFlat(const Vec3d& from, const Vec3d& to, const Vec3d& one, const Vec3d& other) {
  const Vec3d edge = minus(to, from);
  const auto out = [&](const Vec3d& p) {
    const Vec3d offset = minus(p, from);
    return minus(offset, times(edge, dot(offset, edge) / dot(edge, edge)));
  };
  const Vec3d u = out(one), v = out(other);
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

// Edges that are not nearly flat, in the order of the table.
std::vector<std::uint32_t> sharpEdges(const EdgeTable& table, const std::vector<Vec3d>& points) {
  std::vector<std::uint8_t> isSharp(table.edgeCount());
  forEachIndex(table.edgeCount(), [&](std::size_t i) {
    const auto edge = static_cast<std::uint32_t>(i);
    const EdgeTable::Sides sides = table.sides(edge);
    if (sides.size() == 2) {
      const std::uint32_t a = table.opposite(sides[0]), b = table.opposite(sides[1]);
      isSharp[i] = !isFlat(points[table.lowPoint(edge)], points[table.highPoint(edge)],
                           points[std::min(a, b)], points[std::max(a, b)]);
    } else {
      isSharp[i] = 1;
    }
  });
  std::vector<std::uint32_t> sharp;
  for (std::uint32_t edge = 0; edge < table.edgeCount(); ++edge)
    if (isSharp[edge])
      sharp.push_back(edge);
  return sharp;
}

// `points`: more landmarks.
std::vector<Box> landmarksOf(const Envelope& surface, double radius, std::vector<Vec3d> points) {
  const std::vector<Landmarks::Face> faces = surface.faces();
  points.reserve(points.size() + 3 * faces.size());
  for (const Landmarks::Face& face : faces)
    points.insert(points.end(), face.begin(), face.end());
  tbb::parallel_sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::vector<std::uint32_t> corners(3 * faces.size());
  forEachIndex(corners.size(), [&](std::size_t i) {
    corners[i] = static_cast<std::uint32_t>(
        std::lower_bound(points.begin(), points.end(), faces[i / 3][i % 3]) - points.begin());
  });
  const EdgeTable table(corners, points.size());
  const std::vector<std::uint32_t> sharp = sharpEdges(table, points);
  const auto fromOf = [&](std::size_t i) { return points[table.lowPoint(sharp[i])]; };
  const auto alongOf = [&](std::size_t i) {
    return minus(points[table.highPoint(sharp[i])], fromOf(i));
  };
  double total = 0;
  for (std::size_t i = 0; i < sharp.size(); ++i)
    total += length(alongOf(i));
  const double spacing = std::max(radius, total / kMaxIntervals);
  std::vector<std::size_t> starts(sharp.size() + 1, points.size()); // of an edge's landmarks
  for (std::size_t i = 0; i < sharp.size(); ++i)
    starts[i + 1] =
        starts[i] + static_cast<std::size_t>(std::ceil(length(alongOf(i)) / spacing)) - 1;
  std::vector<Box> boxes(starts.back());
  forEachIndex(points.size(), [&](std::size_t i) { boxes[i] = {points[i], points[i]}; });
  forEachIndex(sharp.size(), [&](std::size_t i) {
    const Vec3d from = fromOf(i), along = alongOf(i);
    const auto intervals = static_cast<double>(starts[i + 1] - starts[i] + 1);
    for (std::size_t k = starts[i]; k < starts[i + 1]; ++k) {
      const Vec3d p = plus(from, times(along, static_cast<double>(k - starts[i] + 1) / intervals));
      boxes[k] = {p, p};
    }
  });
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
