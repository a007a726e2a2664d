// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/VectorMath.h"

namespace tetvdb {

/// The point of a triangle nearest to a point, relative to that point.
struct NearestOffset {
  Vec3d offset; ///< from the point to the triangle
  double squared;
};

/// On the segment between a and b, given relative to the point. The same bits for (a, b) and (b,
/// a), so that triangles that share an edge tie there.
TETVDB_HD inline NearestOffset nearestOnSegment(Vec3d a, Vec3d b) {
  if (comesBefore(b, a)) {
    const Vec3d first = b;
    b = a;
    a = first;
  }
  const Vec3d edge = minus(b, a);
  const double square = dot(edge, edge), along = -dot(a, edge);
  Vec3d at = a;
  if (along >= square && square > 0)
    at = b;
  else if (along > 0)
    at = plus(a, times(edge, along / square));
  return {at, dot(at, at)};
}

/// On the triangle a, b, c, given relative to the point. For any shape of the triangle, the result
/// lies on it and is no farther than the nearest point of its edges.
TETVDB_HD inline NearestOffset nearestOnTriangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  NearestOffset best = nearestOnSegment(a, b);
  const NearestOffset second = nearestOnSegment(b, c), third = nearestOnSegment(c, a);
  if (second.squared < best.squared)
    best = second;
  if (third.squared < best.squared)
    best = third;
  const Vec3d normal = cross(minus(b, a), minus(c, a));
  const double u = dot(normal, cross(b, c)), v = dot(normal, cross(c, a)),
               w = dot(normal, cross(a, b));
  if (u > 0 && v > 0 && w > 0) {
    const double sum = u + v + w;
    const Vec3d inside = plus(plus(times(a, u / sum), times(b, v / sum)), times(c, w / sum));
    if (dot(inside, inside) < best.squared)
      best = {inside, dot(inside, inside)};
  }
  return best;
}

} // namespace tetvdb
