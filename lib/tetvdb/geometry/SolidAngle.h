// SPDX-License-Identifier: Apache-2.0
//
// Solid angles of triangles, exact in their signs.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// A triangle relative to some point. Coordinates are whole numbers below 2^53.
struct SeenTriangle {
  Vec3d a, b, c;
};

/// How often a ray straight down from 0 crosses the triangle, where 0 is moved by (e, e^2, e^3),
/// e -> 0+: 1 where it leaves through the back of the face, that is where a, b, c turn clockwise
/// seen from above, -1 where they turn counter-clockwise, 0 where it misses.
std::int32_t crossingBelow(const SeenTriangle& t);

/// The solid angle seen from 0 moved by (e, e^2, e^3), e -> 0+; positive where 0 is on the side
/// that the triangle turns its back to ((b - a) x (c - a) points away).
double solidAngle(const SeenTriangle& t);

/// Points, one array a coordinate, and a sum for each.
struct PointSums {
  const double *x, *y, *z;
  double* sum;
  std::size_t count; ///< kMaxPointSums at most
};
constexpr std::size_t kMaxPointSums = 64;

/// Adds weight * solidAngle() as seen from each of the points, within 1e-9. Points and triangle are
/// relative to the same point, in whole numbers below 2^52. The same bits for every instruction
/// set.
void addSolidAngles(const SeenTriangle& t, double weight, const PointSums& points);

/// The same from points that are about as far from the triangle as `unit` or farther, each angle
/// within 2e-5, in half the time.
void addFarSolidAngles(const SeenTriangle& t, double weight, double unit, const PointSums& points);

} // namespace tetvdb
