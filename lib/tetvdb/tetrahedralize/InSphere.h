// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cmath>

namespace tetvdb {

/// The sign that rounding hides from liesInSphere().
bool liesInSphereExactly(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d,
                         const Vec3d& p);

/// Whether p lies strictly inside the sphere through the corners of a tet, positive by
/// latticeOrientation(). Exact for lattice points.
///   The determinant of the rows (x, y, z, x^2 + y^2 + z^2) relative to p. Differences are exact;
/// minors of two rows are off by 2 roundings of their terms' magnitudes, of three by 5, squares by
/// 3; their product by 9 and the sum of four by 11: 16 leaves room for the rounding of the bound.
inline bool liesInSphere(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d,
                         const Vec3d& p) {
  const double ax = a[0] - p[0], ay = a[1] - p[1], az = a[2] - p[2];
  const double bx = b[0] - p[0], by = b[1] - p[1], bz = b[2] - p[2];
  const double cx = c[0] - p[0], cy = c[1] - p[1], cz = c[2] - p[2];
  const double dx = d[0] - p[0], dy = d[1] - p[1], dz = d[2] - p[2];
  const double axby = ax * by, aybx = ay * bx, axcy = ax * cy, aycx = ay * cx, axdy = ax * dy,
               aydx = ay * dx, bxcy = bx * cy, bycx = by * cx, bxdy = bx * dy, bydx = by * dx,
               cxdy = cx * dy, cydx = cy * dx;
  const double ab = axby - aybx, ac = axcy - aycx, ad = axdy - aydx, bc = bxcy - bycx,
               bd = bxdy - bydx, cd = cxdy - cydx;
  const double aa = ax * ax + ay * ay + az * az, bb = bx * bx + by * by + bz * bz;
  const double cc = cx * cx + cy * cy + cz * cz, dd = dx * dx + dy * dy + dz * dz;
  const double det = (aa * (bz * cd - cz * bd + dz * bc) - bb * (az * cd - cz * ad + dz * ac)) +
                     (cc * (az * bd - bz * ad + dz * ab) - dd * (az * bc - bz * ac + cz * ab));
  const double u = std::abs(az), v = std::abs(bz), w = std::abs(cz), x = std::abs(dz);
  const double mab = std::abs(axby) + std::abs(aybx), mac = std::abs(axcy) + std::abs(aycx),
               mad = std::abs(axdy) + std::abs(aydx), mbc = std::abs(bxcy) + std::abs(bycx),
               mbd = std::abs(bxdy) + std::abs(bydx), mcd = std::abs(cxdy) + std::abs(cydx);
  const double size = aa * (v * mcd + w * mbd + x * mbc) + bb * (u * mcd + w * mad + x * mac) +
                      cc * (u * mbd + v * mad + x * mab) + dd * (u * mbc + v * mac + w * mab);
  constexpr double kError = 1.8e-15; // 16 * 2^-53, rounded up
  if (det > kError * size)
    return true;
  if (det < -kError * size)
    return false;
  return liesInSphereExactly(a, b, c, d, p);
}

} // namespace tetvdb
