// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/PlaneHoles.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/TriangulatePolygon.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

// Maximum distance of a plane loop's points from the plane, relative to the loop's size.
constexpr double kFlat = 1e-4;
// Longer loops are not tested for a plane, since the time is quadratic.
constexpr std::size_t kMaxPlanePoints = 4096;
constexpr double kOpposite = -0.999; // cosine between the normals of an outline and a loop within

} // namespace

PlaneHoles::PlaneHoles(const TriangleMesh& mesh, const EdgeTable& edges)
    : mesh_(mesh), loops_(findBoundaryLoops(mesh, edges)) {
  std::vector<char> onLoop(mesh.points.size(), 0);
  for (const BoundaryLoop& loop : loops_) {
    planes_.push_back(planeOf(mesh.points, loop));
    for (const std::uint32_t point : loop.points)
      onLoop[point] = 1;
  }
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
    if (onLoop[edges.lowPoint(edge)] != 0 && onLoop[edges.highPoint(edge)] != 0)
      taken_.insert(key(edges.lowPoint(edge), edges.highPoint(edge)));
  group();
}

std::uint64_t PlaneHoles::key(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b);
}

PlaneHoles::Plane PlaneHoles::planeOf(const std::vector<Vec3d>& points, const BoundaryLoop& loop) {
  Plane plane;
  plane.origin = points[loop.points[0]];
  Vec3d sum{0, 0, 0};
  for (std::size_t i = 0; i < loop.points.size(); ++i) {
    const Vec3d& p = points[loop.points[i]];
    plane.box.add(p);
    sum = plus(sum, cross(minus(p, plane.origin),
                          minus(points[loop.points[(i + 1) % loop.points.size()]], plane.origin)));
  }
  plane.size = length(minus(plane.box.high, plane.box.low));
  plane.area = length(sum) / 2;
  if (!(plane.area > 0))
    return plane;
  plane.normal = times(sum, 0.5 / plane.area);
  double low = 0, high = 0;
  for (const std::uint32_t i : loop.points) {
    const double height = dot(minus(points[i], plane.origin), plane.normal);
    low = std::min(low, height);
    high = std::max(high, height);
  }
  plane.flat = high - low <= kFlat * plane.size && loop.points.size() <= kMaxPlanePoints;
  return plane;
}

// Assigns loops to the smallest loop around them in the same plane and of opposite direction.
void PlaneHoles::group() {
  std::vector<Box> boxes;
  for (const Plane& plane : planes_)
    boxes.push_back(plane.box);
  const BoxTree tree(boxes);
  std::vector<std::vector<std::size_t>> within(loops_.size());
  std::vector<char> isInner(loops_.size(), 0);
  for (std::uint32_t inner = 0; inner < loops_.size(); ++inner) {
    const Plane& small = planes_[inner];
    if (!small.flat)
      continue;
    std::size_t best = loops_.size();
    tree.visit([&](const Box& box) { return box.meets(small.box); },
               [&](std::uint32_t outer) {
                 const Plane& large = planes_[outer];
                 if (outer != inner && large.flat && large.area > small.area &&
                     dot(large.normal, small.normal) < kOpposite &&
                     std::abs(dot(minus(small.origin, large.origin), large.normal)) <=
                         kFlat * large.size &&
                     (best == loops_.size() || large.area < planes_[best].area) &&
                     isAround(outer, small.origin))
                   best = outer;
                 return false;
               });
    if (best == loops_.size() || isInner[best] != 0)
      continue;
    within[best].push_back(inner);
    isInner[inner] = 1;
  }
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    if (isInner[i] != 0)
      continue;
    groups_.push_back({i});
    groups_.back().insert(groups_.back().end(), within[i].begin(), within[i].end());
  }
}

// Whether a plane loop encloses a point of its plane, by the sum of angles.
bool PlaneHoles::isAround(std::size_t loop, const Vec3d& p) const {
  double turn = 0;
  const std::vector<std::uint32_t>& points = loops_[loop].points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d a = minus(mesh_.points[points[i]], p);
    const Vec3d b = minus(mesh_.points[points[(i + 1) % points.size()]], p);
    turn += std::atan2(dot(cross(a, b), planes_[loop].normal), dot(a, b));
  }
  return std::abs(turn) > 3;
}

std::size_t PlaneHoles::edgesOf(const std::vector<std::size_t>& group) const {
  std::size_t edges = 0;
  for (const std::size_t loop : group)
    edges += loops_[loop].points.size();
  return edges;
}

bool PlaneHoles::triangulate(const std::vector<std::size_t>& group,
                             std::vector<std::uint32_t>& corners) const {
  if (!isFlat(group))
    return false;
  std::vector<std::vector<std::uint32_t>> outlines;
  for (const std::size_t loop : group)
    outlines.push_back(loops_[loop].points);
  return triangulatePolygon(
      mesh_.points, outlines, planes_[group[0]].normal,
      [&](std::uint32_t a, std::uint32_t b) { return isTaken(a, b); }, corners);
}

void PlaneHoles::take(const std::vector<std::uint32_t>& corners, std::size_t first) {
  for (std::size_t i = first; i < corners.size(); ++i)
    taken_.insert(key(corners[i], corners[i % 3 == 2 ? i - 2 : i + 1]));
}

} // namespace tetvdb
