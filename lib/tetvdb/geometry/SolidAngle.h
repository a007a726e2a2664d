// SPDX-License-Identifier: Apache-2.0
//
// Solid angles of triangles, exact in their signs.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// A triangle relative to a point. Coordinates are integers below 2^53.
struct SeenTriangle {
  Vec3d a, b, c;
};

/// The number of times that a downward ray from 0 crosses the triangle, where 0 is moved by (e,
/// e^2, e^3), e -> 0+: 1 if it leaves through the back of the face, that is if a, b, c are
/// clockwise seen from above, -1 if they are counter-clockwise, 0 if it misses.
std::int32_t crossingBelow(const SeenTriangle& t);

/// The solid angle seen from 0 moved by (e, e^2, e^3), e -> 0+; positive if 0 is on the back side
/// of the triangle ((b - a) x (c - a) points away).
double solidAngle(const SeenTriangle& t);

/// Points, one array per coordinate, and a sum for each.
struct PointSums {
  const double *x, *y, *z;
  double* sum;
  std::size_t count; ///< kMaxPointSums at most
};
constexpr std::size_t kMaxPointSums = 64;

/// Adds weight * solidAngle() seen from each of the points, within 1e-9. Points and triangle
/// are relative to the same point, in integers below 2^52. The same bits for every instruction
/// set.
void addSolidAngles(const SeenTriangle& t, double weight, const PointSums& points);

/// The same for points at about the distance `unit` from the triangle or farther, each angle within
/// 2e-5, in half the time.
void addFarSolidAngles(const SeenTriangle& t, double weight, double unit, const PointSums& points);

} // namespace tetvdb
