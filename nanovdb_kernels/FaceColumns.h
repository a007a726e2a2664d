// SPDX-License-Identifier: Apache-2.0
//
// Computes exactly where the z columns of voxel centres cross a boundary face, by the rule of
// geometry/Ownership.h, as voxelize/FaceRaster.h does, in a form for the device. Every decision is
// made in doubles with a proven bound on their error, or else in 128-bit integers.
#pragma once

#include "Team.h"
#include "tetvdb/geometry/ColumnBounds.h"

#include <cmath>

namespace tetvdb::nano {

constexpr double kUnits = static_cast<double>(kUnitsPerVoxel);

TETVDB_HD inline double minOf(double a, double b) {
  return a < b ? a : b;
}
TETVDB_HD inline double maxOf(double a, double b) {
  return a > b ? a : b;
}
TETVDB_HD inline double minOf(double a, double b, double c) {
  return minOf(minOf(a, b), c);
}
TETVDB_HD inline double maxOf(double a, double b, double c) {
  return maxOf(maxOf(a, b), c);
}
TETVDB_HD inline double absolute(double a) {
  return a < 0 ? -a : a;
}

/// Whether column (x, y) is crossed: its perturbed centre lies inside the face seen along z.
TETVDB_HD inline bool crossesColumn(const CrossedFace& f, i64 x, i64 y) {
  const double cx = static_cast<double>(x) * kUnits, cy = static_cast<double>(y) * kUnits;
  for (int k = 0; k < 3; ++k) {
    const LatticePoint& p = f.p[k];
    const LatticePoint& q = f.p[k == 2 ? 0 : k + 1];
    const double b = q.x - p.x, d = q.y - p.y, ex = cx - p.x, ey = cy - p.y;
    const double left = b * ey, right = d * ex;
    const double value = left - right;
    // The differences are exact; two products and their difference round once each.
    const double bound = (absolute(left) + absolute(right)) * 0x1p-51;
    if (value > bound)
      continue;
    if (value < -bound)
      return false;
    const Int128 exact = Int128(static_cast<i64>(b)) * static_cast<i64>(ey) -
                         Int128(static_cast<i64>(d)) * static_cast<i64>(ex);
    const int sign = signOf(exact);
    if (sign < 0 || (sign == 0 && tieSign(-d, b, 0.0) <= 0))
      return false;
  }
  return true;
}

/// Voxel of column (x, y), counted from z0, from which on the crossing counts; some number outside
/// 0..span-1 where it is not one of these.
TETVDB_HD inline i64 crossingFrom(const CrossedFace& f, i64 x, i64 y, i64 z0, int span) {
  const LatticePoint& o = f.p[0];
  const double oz = (o.z - static_cast<double>(z0) * kUnits) * kVoxelsPerUnit;
  const double crossing = oz + f.slopeX * (static_cast<double>(x) - o.x * kVoxelsPerUnit) +
                          f.slopeY * (static_cast<double>(y) - o.y * kVoxelsPerUnit);
  if (f.tolerance >= kSteep) {
    if (!(crossing > -2 - f.tolerance && crossing < span + 2 + f.tolerance))
      return -1;
    return f.exactCrossing(x, y, z0) - z0;
  }
  if (!(crossing > -2 && crossing < span + 2))
    return -1;
  const double nearest = rint(crossing);
  if (absolute(crossing - nearest) <= f.tolerance)
    return f.exactCrossing(x, y, z0 + static_cast<i64>(nearest)) - z0;
  return static_cast<i64>(nearest) + (crossing > nearest ? 1 : 0);
}

} // namespace tetvdb::nano
