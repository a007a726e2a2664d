// SPDX-License-Identifier: Apache-2.0
//
// The exact intersections of the z columns of voxel centres with lattice planes and triangles: the
// rule of Ownership.h by columns, for the rasterisers of host and device.
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/geometry/Exact.h"
#include "tetvdb/geometry/Lattice.h"
#include "tetvdb/geometry/Ownership.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tetvdb {

/// From this tolerance on (voxels), a plane is too steep for its crossings in doubles.
constexpr double kSteep = 0.25;

/// Lattice units from `origin` to a voxel centre.
TETVDB_HD inline std::int64_t unitsFrom(double origin, std::int64_t voxel) {
  return static_cast<std::int64_t>(
      static_cast<double>(voxel) * static_cast<double>(kUnitsPerVoxel) - origin);
}

/// First voxel along an axis beyond the plane where slope * (v - origin) + rest is 0, v in lattice
/// units: the first inside (above 0, or on it if `tieIn`) for a rising plane, the first outside for
/// a falling one. The plane is at most 2^40 units from `near`, a voxel to which numbers are
/// relative, so that they fit 128 bits anywhere in index space.
TETVDB_HD inline std::int64_t firstBeyond(Int128 slope, Int128 rest, bool tieIn, double origin,
                                          std::int64_t near) {
  const bool rises = slope > 0;
  const Int128 at = -unitsFrom(origin, near);
  const Int128 step = (rises ? slope : -slope) * kUnitsPerVoxel;
  const Int128 number = rises ? slope * at - rest : rest - slope * at;
  const bool ceiling = rises == tieIn;
  return near + static_cast<std::int64_t>(ceiling ? ceilDivide(number, step)
                                                  : floorDivide(number, step) + 1);
}

/// First voxel of column (x, y) beyond the plane through `point` with normal n, n.z != 0: the first
/// inside if n.z > 0, else the first outside. Unless the plane is `steep`, the crossing must be
/// within half a voxel of zNear.
TETVDB_HD inline std::int64_t exactBound(const ExactVector& n, const LatticePoint& point,
                                         bool steep, std::int64_t x, std::int64_t y,
                                         std::int64_t zNear) {
  const Int128 planar = n.x * unitsFrom(point.x, x) + n.y * unitsFrom(point.y, y);
  const bool tieIn = tieSign(n.x, n.y, n.z) > 0;
  if (steep)
    return firstBeyond(n.z, planar, tieIn, point.z, zNear);
  const int sign = signOf(planar + n.z * unitsFrom(point.z, zNear));
  const bool inside = sign > 0 || (sign == 0 && tieIn);
  return inside == (n.z > 0) ? zNear : zNear + 1;
}

/// A boundary face seen along z. Columns are (x, y) of voxel centres; a column crosses the face if
/// its perturbed centre (x + e, y + e^2) is inside the triangle, by the ownership rule without z.
struct CrossedFace {
  LatticePoint p[3];             ///< counter-clockwise seen from +z, if it is crossed
  double slopeX = 0, slopeY = 0; ///< dz/dx, dz/dy of the plane
  double tolerance = 0;          ///< voxels; bound on the error of a crossing at the face's columns
  std::int32_t weight = 0;       ///< of a crossing: > 0 entering
  std::uint32_t crosses = 0;     ///< 0: not crossed: parallel to z, or between the columns
  /// Columns and crossings lie within these inclusive bounds, voxels.
  std::int32_t xMin = 0, xMax = 0, yMin = 0, yMax = 0, zMin = 0, zMax = 0;

  CrossedFace() = default;
  /// Normal of a, b, c pointing out of the mesh; extents at most kMaxTetExtent.
  TETVDB_HD inline CrossedFace(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
                               std::int32_t weightOfFace);

  /// First voxel above the plane in column (x, y); zNear as for exactBound().
  TETVDB_HD TETVDB_APART inline std::int64_t exactCrossing(std::int64_t x, std::int64_t y,
                                                           std::int64_t zNear) const {
    return exactBound(triangleNormal(p[0], p[1], p[2]), p[0], tolerance >= kSteep, x, y, zNear);
  }

  /// Bounds of the crossings in the columns x0..x1, y0..y1 (inclusive); returns false if there are
  /// none. Conservative.
  TETVDB_HD inline bool range(std::int64_t x0, std::int64_t x1, std::int64_t y0, std::int64_t y1,
                              std::int64_t& low, std::int64_t& high) const;
};

TETVDB_HD inline CrossedFace::CrossedFace(const LatticePoint& a, const LatticePoint& b,
                                          const LatticePoint& c, std::int32_t weightOfFace)
    : p{a, b, c} {
  const auto min = [](double u, double v, double w) { return std::min(std::min(u, v), w); };
  const auto max = [](double u, double v, double w) { return std::max(std::max(u, v), w); };
  const LatticePoint low{min(a.x, b.x, c.x), min(a.y, b.y, c.y), min(a.z, b.z, c.z)};
  const LatticePoint high{max(a.x, b.x, c.x), max(a.y, b.y, c.y), max(a.z, b.z, c.z)};
  xMin = static_cast<std::int32_t>(ceilVoxel(low.x));
  xMax = static_cast<std::int32_t>(floorVoxel(high.x));
  yMin = static_cast<std::int32_t>(ceilVoxel(low.y));
  yMax = static_cast<std::int32_t>(floorVoxel(high.y));
  zMin = static_cast<std::int32_t>(ceilVoxel(low.z));
  zMax = static_cast<std::int32_t>(floorVoxel(high.z)) + 1;
  if (xMin > xMax || yMin > yMax)
    return;
  ExactVector n = triangleNormal(a, b, c);
  if (n.z == 0)
    return;
  crosses = 1;
  if (n.z < 0) {
    p[1] = c;
    p[2] = b;
    n = {-n.x, -n.y, -n.z};
    weight = weightOfFace;
  } else {
    weight = -weightOfFace;
  }
  slopeX = -static_cast<double>(n.x) / static_cast<double>(n.z);
  slopeY = -static_cast<double>(n.y) / static_cast<double>(n.z);
  // z = Pz + slopeX (x - Px) + slopeY (y - Py): each slope has three roundings, each product and
  // sum one more; 2^-49 includes a factor of two. 256: Pz is relative to a node that contains or is
  // adjacent to the crossing.
  tolerance = (std::abs(slopeX) * ((high.x - low.x) * kVoxelsPerUnit + 1) +
               std::abs(slopeY) * ((high.y - low.y) * kVoxelsPerUnit + 1) +
               (high.z - low.z) * kVoxelsPerUnit + 256) *
              0x1p-49;
}

TETVDB_HD inline bool CrossedFace::range(std::int64_t x0, std::int64_t x1, std::int64_t y0,
                                         std::int64_t y1, std::int64_t& low,
                                         std::int64_t& high) const {
  x0 = x0 > xMin ? x0 : xMin;
  x1 = x1 < xMax ? x1 : xMax;
  y0 = y0 > yMin ? y0 : yMin;
  y1 = y1 < yMax ? y1 : yMax;
  if (x0 > x1 || y0 > y1)
    return false;
  const LatticePoint& o = p[0];
  const double left = static_cast<double>(x0) - o.x * kVoxelsPerUnit,
               right = static_cast<double>(x1) - o.x * kVoxelsPerUnit,
               front = static_cast<double>(y0) - o.y * kVoxelsPerUnit,
               back = static_cast<double>(y1) - o.y * kVoxelsPerUnit;
  for (int k = 0; k < 3; ++k) {
    const LatticePoint &from = p[k], &to = p[k == 2 ? 0 : k + 1];
    const double b = (to.x - from.x) * kVoxelsPerUnit, d = (to.y - from.y) * kVoxelsPerUnit;
    const double px = (from.x - o.x) * kVoxelsPerUnit, py = (from.y - o.y) * kVoxelsPerUnit;
    const double farY = (b > 0 ? back : front) - py, farX = (d > 0 ? left : right) - px;
    if (b * farY - d * farX < -1e-12 * (std::abs(b * farY) + std::abs(d * farX)))
      return false;
  }
  const std::int64_t oz = floorVoxel(o.z);
  const double rest =
      (o.z - static_cast<double>(oz) * static_cast<double>(kUnitsPerVoxel)) * kVoxelsPerUnit;
  const double ax = slopeX * left, bx = slopeX * right, ay = slopeY * front, by = slopeY * back;
  // A crossing at c is counted from the first voxel at or above c, or from c + 1 if c is a voxel.
  const double lowest = rest + std::min(ax, bx) + std::min(ay, by) - tolerance;
  const double highest = rest + std::max(ax, bx) + std::max(ay, by) + tolerance;
  low = zMin;
  high = zMax;
  if (lowest > static_cast<double>(low - oz))
    low = oz + static_cast<std::int64_t>(std::ceil(std::min(lowest, 5e9)));
  if (highest + 1 < static_cast<double>(high - oz))
    high = oz + static_cast<std::int64_t>(std::floor(std::max(highest, -5e9))) + 1;
  return low <= high;
}

} // namespace tetvdb
