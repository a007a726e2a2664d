// SPDX-License-Identifier: Apache-2.0
//
// Exact orientation of points in doubles: a floating-point filter first, then expansions (sums of
// doubles that do not overlap) if it does not decide.
//
// Exact if no product of coordinates overflows or underflows: coordinates are 0 or multiples of
// 2^-320 below 2^320.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <array>

namespace tetvdb {

using Vec2d = std::array<double, 2>;

/// 1 if d lies on the side of the plane through a, b, c that sees them counter-clockwise (where (b
/// - a) x (c - a) points to), -1 on the other side, 0 in the plane.
int orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

/// 1 if a, b, c are counter-clockwise, -1 if clockwise, 0 if collinear.
int orientation(const Vec2d& a, const Vec2d& b, const Vec2d& c);

/// Whether a, b, c are collinear or equal.
bool areCollinear(const Vec3d& a, const Vec3d& b, const Vec3d& c);

} // namespace tetvdb
