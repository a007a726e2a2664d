// SPDX-License-Identifier: Apache-2.0
//
// The boundary of a union of convex bodies in long doubles: every face of a body, a polygon, less
// the insides of all other bodies, by clipping at one plane after the other. For bodies in general
// position: no two faces lie in one plane. Nothing of the library in it.
#pragma once

#include "fields/BruteDistance.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace tetvdb::oracle {

using Polygon = std::vector<Point>;

struct HalfSpace {
  Point normal;
  long double offset;
  long double operator()(const Point& p) const { return product(normal, p) - offset; } // < 0 inside
};

/// Faces whose corners turn counter-clockwise as seen from outside.
struct Body {
  std::vector<Polygon> faces;
  std::vector<HalfSpace> planes;

  void add(const Polygon& face) {
    const Point n = perpendicular(from(face[0], face[1]), from(face[0], face[2]));
    faces.push_back(face);
    planes.push_back({n, product(n, face[0])});
  }
  bool holds(const Point& p) const {
    return std::all_of(planes.begin(), planes.end(),
                       [&](const HalfSpace& plane) { return plane(p) < 0; });
  }
};

inline Body tetBody(std::array<Point, 4> t) {
  if (product(perpendicular(from(t[0], t[1]), from(t[0], t[2])), from(t[0], t[3])) < 0)
    std::swap(t[0], t[1]);
  Body body;
  body.add({t[0], t[2], t[1]});
  body.add({t[0], t[1], t[3]});
  body.add({t[1], t[2], t[3]});
  body.add({t[2], t[0], t[3]});
  return body;
}

/// The part of a polygon on the outer (sign 1) or inner (-1) side of a plane.
inline Polygon clipped(const Polygon& polygon, const HalfSpace& plane, long double sign) {
  Polygon part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const long double fromA = sign * plane(a), fromB = sign * plane(b);
    if (fromA >= 0)
      part.push_back(a);
    if ((fromA > 0 && fromB < 0) || (fromA < 0 && fromB > 0)) {
      const long double t = fromA / (fromA - fromB);
      part.push_back(
          {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])});
    }
  }
  return part.size() < 3 ? Polygon() : part;
}

inline void subtract(std::vector<Polygon>& polygons, const Body& body) {
  std::vector<Polygon> rest;
  for (Polygon inner : polygons)
    for (const HalfSpace& plane : body.planes) {
      Polygon outer = clipped(inner, plane, 1);
      if (!outer.empty())
        rest.push_back(std::move(outer));
      inner = clipped(inner, plane, -1);
      if (inner.empty())
        break;
    }
  polygons = std::move(rest);
}

inline std::vector<Polygon> boundaryOfUnion(const std::vector<Body>& bodies) {
  std::vector<Polygon> all;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    std::vector<Polygon> rest = bodies[i].faces;
    for (std::size_t k = 0; k < bodies.size(); ++k)
      if (k != i)
        subtract(rest, bodies[k]);
    all.insert(all.end(), rest.begin(), rest.end());
  }
  return all;
}

/// Distances to polygons, those left out whose bounding balls are farther than what was found.
class PolygonDistance {
public:
  explicit PolygonDistance(const std::vector<Polygon>& polygons) {
    for (const Polygon& polygon : polygons)
      for (std::size_t i = 2; i < polygon.size(); ++i) {
        Triangle t{polygon[0], polygon[i - 1], polygon[i], {}, 0};
        for (std::size_t k = 0; k < 3; ++k)
          t.midpoint[k] = (t.a[k] + t.b[k] + t.c[k]) / 3;
        for (const Point& corner : {t.a, t.b, t.c})
          t.radius = std::max(t.radius, length(from(t.midpoint, corner)) * (1 + 1e-15L));
        triangles_.push_back(t);
      }
  }
  /// Up to `max`.
  long double operator()(const Point& p, long double max) const {
    long double nearest = max;
    for (const Triangle& t : triangles_)
      if (length(from(t.midpoint, p)) - t.radius < nearest)
        nearest = std::min(nearest, distanceToTriangle(p, t.a, t.b, t.c));
    return nearest;
  }

private:
  struct Triangle {
    Point a, b, c, midpoint;
    long double radius;
  };
  static long double length(const Point& v) { return std::sqrt(product(v, v)); }
  std::vector<Triangle> triangles_;
};

} // namespace tetvdb::oracle
