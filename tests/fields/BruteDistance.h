// SPDX-License-Identifier: Apache-2.0
//
// The distance from a point to a triangle in long doubles, by cases: the nearest point of the plane
// where that is inside, else the nearest of the three segments. Nothing of the library in it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace tetvdb::oracle {

using Point = std::array<long double, 3>;

inline Point from(const Point& a, const Point& b) {
  return {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
}
inline long double product(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Point perpendicular(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline long double distanceToSegment(const Point& p, const Point& a, const Point& b) {
  const Point edge = from(a, b), way = from(a, p);
  const long double square = product(edge, edge);
  const long double t = square > 0 ? std::clamp(product(way, edge) / square, 0.0L, 1.0L) : 0.0L;
  const Point rest{way[0] - t * edge[0], way[1] - t * edge[1], way[2] - t * edge[2]};
  return std::sqrt(product(rest, rest));
}

inline long double distanceToTriangle(const Point& p, const Point& a, const Point& b,
                                      const Point& c) {
  const Point normal = perpendicular(from(a, b), from(a, c));
  const long double area = std::sqrt(product(normal, normal));
  long double nearest = std::min(
      {distanceToSegment(p, a, b), distanceToSegment(p, b, c), distanceToSegment(p, c, a)});
  if (area > 0) {
    const bool over = product(perpendicular(from(a, b), from(a, p)), normal) >= 0 &&
                      product(perpendicular(from(b, c), from(b, p)), normal) >= 0 &&
                      product(perpendicular(from(c, a), from(c, p)), normal) >= 0;
    if (over)
      nearest = std::min(nearest, std::abs(product(from(a, p), normal)) / area);
  }
  return nearest;
}

/// The least over the triangles.
template <typename Points, typename Indices>
long double distanceToAll(const Point& p, const Points& points, const Indices& triangles) {
  long double nearest = std::numeric_limits<long double>::infinity();
  const auto corner = [&](std::size_t i) {
    const auto& q = points[triangles[i]];
    return Point{q[0], q[1], q[2]};
  };
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3)
    nearest = std::min(nearest, distanceToTriangle(p, corner(t), corner(t + 1), corner(t + 2)));
  return nearest;
}

} // namespace tetvdb::oracle
