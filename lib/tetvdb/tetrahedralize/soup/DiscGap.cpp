// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/soup/DiscGap.h"

#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetvdb {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Faces seen under a sharper angle (its sine) have no meaningful gap along the direction.
constexpr double kMinSine = 0.05;

// Two axes across a direction and one along it, of unit length.
struct Frame {
  Vec3d x, y, z;

  explicit Frame(const Vec3d& direction) : z(times(direction, 1 / length(direction))) {
    Vec3d away{0, 0, 0};
    away[std::abs(z[0]) < 0.6 ? 0 : 1] = 1;
    x = cross(away, z);
    x = times(x, 1 / length(x));
    y = cross(z, x);
  }
  Vec3d of(const Vec3d& p) const { return {dot(p, x), dot(p, y), dot(p, z)}; }
};

double area(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// Whether the interiors of two triangles in the plane meet: no edge of one has the other on its
// outer side.
bool overlap(const std::array<Vec3d, 3>& u, const std::array<Vec3d, 3>& v) {
  const auto isApart = [](const std::array<Vec3d, 3>& p, const std::array<Vec3d, 3>& q) {
    for (std::size_t k = 0; k < 3; ++k)
      if (area(p[k], p[(k + 1) % 3], q[0]) <= 0 && area(p[k], p[(k + 1) % 3], q[1]) <= 0 &&
          area(p[k], p[(k + 1) % 3], q[2]) <= 0)
        return true;
    return false;
  };
  return !isApart(u, v) && !isApart(v, u);
}

// How far p is above or below a triangle; less than 0 where it is not over the triangle.
double heightOver(const Vec3d& p, const std::array<Vec3d, 3>& at) {
  const double u = area(p, at[1], at[2]), v = area(p, at[2], at[0]), w = area(p, at[0], at[1]);
  if (!(u >= 0 && v >= 0 && w >= 0 && u + v + w > 0))
    return -1;
  return std::abs((u * at[0][2] + v * at[1][2] + w * at[2][2]) / (u + v + w) - p[2]);
}

// How far edges are from one another where they cross; 0 where they do not.
double gapAtCrossing(const Vec3d& p, const Vec3d& q, const Vec3d& r, const Vec3d& s) {
  const double ofR = area(p, q, r), ofS = area(p, q, s), ofP = area(r, s, p), ofQ = area(r, s, q);
  if (!((ofR < 0) != (ofS < 0) && (ofP < 0) != (ofQ < 0)))
    return 0;
  const double here = p[2] + (q[2] - p[2]) * (ofP / (ofP - ofQ));
  const double there = r[2] + (s[2] - r[2]) * (ofR / (ofR - ofS));
  return std::abs(here - there);
}

} // namespace

bool goRoundOnce(const Disc& fan, const Vec3d& direction) {
  if (!(dot(direction, direction) > 0))
    return false;
  const Frame frame(direction);
  int turns = 0;
  for (const Disc::Face& face : fan.faces) {
    const auto& [centre, from, to] = face.at;
    turns += dot(minus(from, centre), frame.y) < 0 && dot(minus(to, centre), frame.y) >= 0;
  }
  return turns == 1;
}

void DiscGap::findDepths(const Disc& before, Disc& after, const Vec3d& direction) {
  for (Disc::Face& face : after.faces)
    face.depth = kInfinity;
  if (before.faces.empty() || !(dot(direction, direction) > 0))
    return;
  const Frame frame(direction);
  const Vec3d origin = before.faces[0].at[0];
  const auto flatten = [&](const Disc& disc, std::vector<Flat>& flat) {
    flat.clear();
    for (const Disc::Face& face : disc.faces) {
      const Vec3d normal = cross(minus(face.at[1], face.at[0]), minus(face.at[2], face.at[0]));
      if (!(dot(normal, frame.z) > kMinSine * length(normal)))
        return false;
      flat.emplace_back();
      for (std::size_t k = 0; k < 3; ++k)
        flat.back().at[k] = frame.of(minus(face.at[k], origin));
    }
    return true;
  };
  if (!flatten(before, old_) || !flatten(after, made_))
    return;
  oldEdges_.clear();
  for (const Disc::Edge& edge : before.edges)
    oldEdges_.push_back({frame.of(minus(edge.from, origin)), frame.of(minus(edge.to, origin))});

  double ofPoints = 0; // of points inside the new disc, which are corners of all of its faces
  for (const Vec3d& point : after.points) {
    const Vec3d p = frame.of(minus(point, origin));
    double height = -1;
    for (std::size_t i = 0; i < old_.size() && height < 0; ++i)
      height = heightOver(p, old_[i].at);
    ofPoints = std::max(ofPoints, height < 0 ? kInfinity : height);
  }
  for (std::size_t i = 0; i < made_.size(); ++i) {
    const auto& at = made_[i].at;
    double gap = ofPoints, depth = 0;
    for (const Vec3d& point : before.points)
      gap = std::max(gap, heightOver(frame.of(minus(point, origin)), at));
    for (std::size_t e = 0; e < oldEdges_.size(); ++e)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = after.faces[i].numbers[k], b = after.faces[i].numbers[(k + 1) % 3];
        const Disc::Edge& edge = before.edges[e];
        if (a != edge.a && a != edge.b && b != edge.a && b != edge.b)
          gap = std::max(gap,
                         gapAtCrossing(oldEdges_[e].from, oldEdges_[e].to, at[k], at[(k + 1) % 3]));
      }
    for (std::size_t j = 0; j < old_.size(); ++j)
      if (before.faces[j].depth > depth && overlap(at, old_[j].at))
        depth = before.faces[j].depth;
    after.faces[i].depth = depth + gap;
  }
}

} // namespace tetvdb
