// SPDX-License-Identifier: Apache-2.0
//
// Where the z columns of voxel centres cross a boundary face, exactly: the rule of
// geometry/Ownership.h by columns, as voxelize/FaceRaster.h has it, in a form for the device. Every
// decision is made in doubles with a proven bound on their error, or else in 128-bit integers.
#pragma once

#include "Team.h"
#include "tetvdb/geometry/Ownership.h"

#include <cmath>

namespace tetvdb::nano {

/// From this tolerance on (voxels) a plane is so steep that doubles say nothing of its crossings.
constexpr double kSteep = 0.25;
constexpr double kUnits = static_cast<double>(kUnitsPerVoxel);

TETVDB_HD inline double least(double a, double b) {
  return a < b ? a : b;
}
TETVDB_HD inline double most(double a, double b) {
  return a > b ? a : b;
}
TETVDB_HD inline double least(double a, double b, double c) {
  return least(least(a, b), c);
}
TETVDB_HD inline double most(double a, double b, double c) {
  return most(most(a, b), c);
}
TETVDB_HD inline double magnitude(double a) {
  return a < 0 ? -a : a;
}

/// A face seen along z: columns x, y and crossings z lie within the bounds (voxels, inclusive).
struct FaceColumns {
  LatticePoint p[3]; // counter-clockwise seen from +z
  double slopeX, slopeY;
  double tolerance; // voxels; bound on the error of a crossing at the face's columns
  i32 weight;       // of a crossing: > 0 entering
  u32 crosses;      // 0: no column can be crossed
  i32 xMin, xMax, yMin, yMax, zMin, zMax;
};

/// Normal of a, b, c pointing out of the mesh.
TETVDB_HD inline FaceColumns prepareFace(const LatticePoint& a, const LatticePoint& b,
                                         const LatticePoint& c, i32 weight) {
  FaceColumns f;
  f.p[0] = a;
  f.p[1] = b;
  f.p[2] = c;
  f.slopeX = f.slopeY = f.tolerance = 0;
  f.weight = 0;
  f.crosses = 0;
  f.xMin = static_cast<i32>(ceilVoxel(least(a.x, b.x, c.x)));
  f.xMax = static_cast<i32>(floorVoxel(most(a.x, b.x, c.x)));
  f.yMin = static_cast<i32>(ceilVoxel(least(a.y, b.y, c.y)));
  f.yMax = static_cast<i32>(floorVoxel(most(a.y, b.y, c.y)));
  f.zMin = static_cast<i32>(ceilVoxel(least(a.z, b.z, c.z)));
  f.zMax = static_cast<i32>(floorVoxel(most(a.z, b.z, c.z))) + 1;
  if (f.xMin > f.xMax || f.yMin > f.yMax)
    return f;
  ExactVector n = triangleNormal(a, b, c);
  if (n.z == 0)
    return f;
  f.crosses = 1;
  if (n.z < 0) {
    f.p[1] = c;
    f.p[2] = b;
    n = {-n.x, -n.y, -n.z};
    f.weight = weight;
  } else {
    f.weight = -weight;
  }
  f.slopeX = -static_cast<double>(n.x) / static_cast<double>(n.z);
  f.slopeY = -static_cast<double>(n.y) / static_cast<double>(n.z);
  // Three roundings a slope, one more a product and a sum; 2^-49 leaves a factor of two. 256: the
  // crossing is taken relative to a place that is at most so far from it, or clearly elsewhere.
  const double ex = most(a.x, b.x, c.x) - least(a.x, b.x, c.x);
  const double ey = most(a.y, b.y, c.y) - least(a.y, b.y, c.y);
  const double ez = most(a.z, b.z, c.z) - least(a.z, b.z, c.z);
  f.tolerance = (magnitude(f.slopeX) * (ex * kVoxelsPerUnit + 1) +
                 magnitude(f.slopeY) * (ey * kVoxelsPerUnit + 1) + ez * kVoxelsPerUnit + 256) *
                (1.0 / static_cast<double>(i64(1) << 49));
  return f;
}

/// Whether column (x, y) is crossed: its perturbed centre lies inside the face seen along z.
TETVDB_HD inline bool crossesColumn(const FaceColumns& f, i64 x, i64 y) {
  const double cx = static_cast<double>(x) * kUnits, cy = static_cast<double>(y) * kUnits;
  for (int k = 0; k < 3; ++k) {
    const LatticePoint& p = f.p[k];
    const LatticePoint& q = f.p[k == 2 ? 0 : k + 1];
    const double b = q.x - p.x, d = q.y - p.y, ex = cx - p.x, ey = cy - p.y;
    const double left = b * ey, right = d * ex;
    const double value = left - right;
    // The differences are exact; two products and their difference round once each.
    const double bound = (magnitude(left) + magnitude(right)) * 0x1p-51;
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

// Lattice units from `origin` to a voxel centre.
TETVDB_HD inline i64 unitsFrom(double origin, i64 voxel) {
  return static_cast<i64>(static_cast<double>(voxel) * kUnits - origin);
}

// First voxel above the plane in column (x, y), by integers; see FaceRaster::exactCrossing().
TETVDB_HD TETVDB_APART inline i64 exactCrossing(const FaceColumns& f, i64 x, i64 y, i64 zNear) {
  const ExactVector n = triangleNormal(f.p[0], f.p[1], f.p[2]);
  const Int128 planar = n.x * unitsFrom(f.p[0].x, x) + n.y * unitsFrom(f.p[0].y, y);
  const bool tieIn = tieSign(n.x, n.y, n.z) > 0;
  if (f.tolerance < kSteep) {
    const int sign = signOf(planar + n.z * unitsFrom(f.p[0].z, zNear));
    return sign > 0 || (sign == 0 && tieIn) ? zNear : zNear + 1;
  }
  const Int128 step = n.z * kUnitsPerVoxel;
  const Int128 num = -n.z * unitsFrom(f.p[0].z, zNear) - planar;
  return zNear + static_cast<i64>(tieIn ? ceilDivide(num, step) : floorDivide(num, step) + 1);
}

/// Voxel of column (x, y), counted from z0, from which on the crossing counts; some number outside
/// 0..span-1 where it is not one of these.
TETVDB_HD inline i64 crossingFrom(const FaceColumns& f, i64 x, i64 y, i64 z0, int span) {
  const LatticePoint& o = f.p[0];
  const double oz = (o.z - static_cast<double>(z0) * kUnits) * kVoxelsPerUnit;
  const double crossing = oz + f.slopeX * (static_cast<double>(x) - o.x * kVoxelsPerUnit) +
                          f.slopeY * (static_cast<double>(y) - o.y * kVoxelsPerUnit);
  if (f.tolerance >= kSteep) {
    if (!(crossing > -2 - f.tolerance && crossing < span + 2 + f.tolerance))
      return -1;
    return exactCrossing(f, x, y, z0) - z0;
  }
  if (!(crossing > -2 && crossing < span + 2))
    return -1;
  const double nearest = rint(crossing);
  if (magnitude(crossing - nearest) <= f.tolerance)
    return exactCrossing(f, x, y, z0 + static_cast<i64>(nearest)) - z0;
  return static_cast<i64>(nearest) + (crossing > nearest ? 1 : 0);
}

/// Bounds of the crossings in the columns x0..x1, y0..y1 (inclusive); false where there are none.
/// Conservative.
TETVDB_HD inline bool crossingRange(const FaceColumns& f, i64 x0, i64 x1, i64 y0, i64 y1, i64& low,
                                    i64& high) {
  x0 = x0 > f.xMin ? x0 : f.xMin;
  x1 = x1 < f.xMax ? x1 : f.xMax;
  y0 = y0 > f.yMin ? y0 : f.yMin;
  y1 = y1 < f.yMax ? y1 : f.yMax;
  if (x0 > x1 || y0 > y1)
    return false;
  const LatticePoint& o = f.p[0];
  const double left = static_cast<double>(x0) - o.x * kVoxelsPerUnit,
               right = static_cast<double>(x1) - o.x * kVoxelsPerUnit,
               front = static_cast<double>(y0) - o.y * kVoxelsPerUnit,
               back = static_cast<double>(y1) - o.y * kVoxelsPerUnit;
  for (int k = 0; k < 3; ++k) {
    const LatticePoint& p = f.p[k];
    const LatticePoint& q = f.p[k == 2 ? 0 : k + 1];
    const double b = (q.x - p.x) * kVoxelsPerUnit, d = (q.y - p.y) * kVoxelsPerUnit;
    const double px = (p.x - o.x) * kVoxelsPerUnit, py = (p.y - o.y) * kVoxelsPerUnit;
    const double farY = (b > 0 ? back : front) - py, farX = (d > 0 ? left : right) - px;
    if (b * farY - d * farX < -1e-12 * (magnitude(b * farY) + magnitude(d * farX)))
      return false;
  }
  const i64 oz = floorVoxel(o.z);
  const double rest = (o.z - static_cast<double>(oz) * kUnits) * kVoxelsPerUnit;
  const double ax = f.slopeX * left, bx = f.slopeX * right, ay = f.slopeY * front,
               by = f.slopeY * back;
  // A crossing at c counts from the first voxel at or above c, or from c + 1 where c is a voxel.
  const double lowest = rest + least(ax, bx) + least(ay, by) - f.tolerance;
  const double highest = rest + most(ax, bx) + most(ay, by) + f.tolerance;
  low = f.zMin;
  high = f.zMax;
  if (lowest > static_cast<double>(low - oz))
    low = oz + static_cast<i64>(ceil(least(lowest, 5e9)));
  if (highest + 1 < static_cast<double>(high - oz))
    high = oz + static_cast<i64>(floor(most(highest, -5e9))) + 1;
  return low <= high;
}

} // namespace tetvdb::nano
