// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"

namespace tetvdb {

/// The case of liesInSphere() that rounding leaves open.
bool liesInSphereExactly(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d,
                         const Vec3d& p);

/// Whether p lies strictly inside the sphere through the corners of a tet, positive by
/// latticeOrientation(). Exact for lattice points.
///   The determinant of the rows (x, y, z, x^2 + y^2 + z^2) relative to p. Differences are exact;
/// minors of two rows are off by 2 roundings of the sums of their terms' absolute values, of three
/// by 5, squares by 3; their product by 9 and the sum of four by 11; 16 leaves room for the bound's
/// own rounding. The absolute values of the terms of a minor of three sum to no more than the
/// product of its rows' sums, sqrt(3) lengths each: with all four to sqrt(27) |a||b||c||d| (|a| +
/// |b| + |c| + |d|), whose last factor is at most 2 sqrt(|a|^2 + |b|^2 + |c|^2 + |d|^2).
inline bool liesInSphere(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d,
                         const Vec3d& p) {
  const double ax = a[0] - p[0], ay = a[1] - p[1], az = a[2] - p[2];
  const double bx = b[0] - p[0], by = b[1] - p[1], bz = b[2] - p[2];
  const double cx = c[0] - p[0], cy = c[1] - p[1], cz = c[2] - p[2];
  const double dx = d[0] - p[0], dy = d[1] - p[1], dz = d[2] - p[2];
  const double ab = ax * by - ay * bx, ac = ax * cy - ay * cx, ad = ax * dy - ay * dx;
  const double bc = bx * cy - by * cx, bd = bx * dy - by * dx, cd = cx * dy - cy * dx;
  const double aa = ax * ax + ay * ay + az * az, bb = bx * bx + by * by + bz * bz;
  const double cc = cx * cx + cy * cy + cz * cz, dd = dx * dx + dy * dy + dz * dz;
  const double det = (aa * (bz * cd - cz * bd + dz * bc) - bb * (az * cd - cz * ad + dz * ac)) +
                     (cc * (az * bd - bz * ad + dz * ab) - dd * (az * bc - bz * ac + cz * ab));
  constexpr double kError = 3.5e-28; // (2 * sqrt(27) * 16 * 2^-53)^2 = 3.41e-28, rounded up
  if (det * det > kError * ((aa * bb) * (cc * dd)) * (aa + bb + cc + dd))
    return det > 0;
  return liesInSphereExactly(a, b, c, d, p);
}

} // namespace tetvdb
