// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/DiscGap.h"

#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetvdb {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Faces seen under a sharper angle (its sine) have gaps along the direction that say little.
constexpr double kLeastSine = 0.05;

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

bool lookAlong(const std::vector<std::array<Vec3d, 3>>& faces, const Vec3d& direction) {
  for (const auto& [a, b, c] : faces) {
    const Vec3d normal = cross(minus(b, a), minus(c, a));
    if (!(dot(normal, direction) > kLeastSine * length(normal)))
      return false;
  }
  return true;
}

// How far p is from faces, all in the frame. Infinite where none is found, by rounding.
double heightOver(const Vec3d& p, const std::vector<std::array<Vec3d, 3>>& faces,
                  const Frame& frame, const Vec3d& origin) {
  for (const auto& face : faces) {
    const Vec3d a = frame.of(minus(face[0], origin)), b = frame.of(minus(face[1], origin)),
                c = frame.of(minus(face[2], origin));
    const double u = area(p, b, c), v = area(p, c, a), w = area(p, a, b);
    if (u >= 0 && v >= 0 && w >= 0 && u + v + w > 0)
      return std::abs((u * a[2] + v * b[2] + w * c[2]) / (u + v + w) - p[2]);
  }
  return kInfinity;
}

} // namespace

bool goRoundOnce(const Disc& fan, const Vec3d& direction) {
  if (!(dot(direction, direction) > 0))
    return false;
  const Frame frame(direction);
  int turns = 0;
  for (const auto& [middle, from, to] : fan.faces)
    turns += dot(minus(from, middle), frame.y) < 0 && dot(minus(to, middle), frame.y) >= 0;
  return turns == 1;
}

double gapBetween(const Disc& before, const Disc& after, const Vec3d& direction) {
  if (before.faces.empty() || !(dot(direction, direction) > 0))
    return kInfinity;
  const Frame frame(direction);
  if (!lookAlong(before.faces, frame.z) || !lookAlong(after.faces, frame.z))
    return kInfinity;
  const Vec3d origin = before.faces[0][0];
  double gap = 0;
  for (const Vec3d& p : before.points)
    gap = std::max(gap, heightOver(frame.of(minus(p, origin)), after.faces, frame, origin));
  for (const Vec3d& p : after.points)
    gap = std::max(gap, heightOver(frame.of(minus(p, origin)), before.faces, frame, origin));
  for (const Disc::Edge& e : before.edges) {
    const Vec3d p = frame.of(minus(e.from, origin)), q = frame.of(minus(e.to, origin));
    for (const Disc::Edge& f : after.edges) {
      if (e.a == f.a || e.a == f.b || e.b == f.a || e.b == f.b)
        continue;
      const Vec3d r = frame.of(minus(f.from, origin)), s = frame.of(minus(f.to, origin));
      const double ofR = area(p, q, r), ofS = area(p, q, s), ofP = area(r, s, p),
                   ofQ = area(r, s, q);
      if (!((ofR < 0) != (ofS < 0) && (ofP < 0) != (ofQ < 0)))
        continue;
      const double here = p[2] + (q[2] - p[2]) * (ofP / (ofP - ofQ));
      const double there = r[2] + (s[2] - r[2]) * (ofR / (ofR - ofS));
      gap = std::max(gap, std::abs(here - there));
    }
  }
  return gap;
}

} // namespace tetvdb
