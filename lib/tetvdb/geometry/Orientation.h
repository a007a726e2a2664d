// SPDX-License-Identifier: Apache-2.0
//
// Orientation of points in doubles, exact: a floating-point filter first, expansions (sums of
// doubles that do not overlap) where it cannot tell.
//
// Exact as long as no product of coordinates over- or underflows: coordinates are 0 or multiples of
// 2^-320 below 2^320.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <array>

namespace tetvdb {

using Vec2d = std::array<double, 2>;

/// 1 where d lies on the side of the plane through a, b, c from which these turn counter-clockwise
/// (where (b - a) x (c - a) points to), -1 on the other, 0 in the plane.
int orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

/// 1 where a, b, c turn counter-clockwise, -1 clockwise, 0 on a line.
int orientation(const Vec2d& a, const Vec2d& b, const Vec2d& c);

/// Whether a, b, c lie on a line, or are equal.
bool areCollinear(const Vec3d& a, const Vec3d& b, const Vec3d& c);

} // namespace tetvdb
