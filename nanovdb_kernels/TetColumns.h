// SPDX-License-Identifier: Apache-2.0
//
// Computes exactly the voxels of a z column that a tet owns, by the rule of geometry/Ownership.h,
// as voxelize/TetRaster.h does, in a form for the device.
#pragma once

#include "FaceColumns.h"
#include "tetvdb/geometry/TetBox.h"
#include "tetvdb/geometry/TetFaces.h"

namespace tetvdb::nano {

/// A tolerance above every distance to a voxel.
constexpr double kNever = 1;

/// The kind of bound that a face of a tet is for columns.
enum class Side : u8 { Lower, Upper, Vertical };

/// A tet's faces as bounds on z by column, relative to the first voxel of its box. Of a lower or an
/// upper bound: crossing = base + slopeX dx + slopeY dy. A face parallel to z has in the same form
/// how far inside of it a column lies (up to a factor).
struct TetPlanes {
  double base[4], slopeX[4], slopeY[4]; // of the face opposite to vertex i
  double tolerance[4]; // bound on the error; kNever: doubles say nothing, the plane is too steep
  i32 min[3], max[3];  // voxels of the box, inclusive
  Side side[4];
  i32 sign; // orientation; 0: owns nothing
};

/// Exact bounds are found from the mesh itself.
struct TetSource {
  const LatticePoint* points;
  const u32* corners; // of the tet
};

/// Finds the planes of a tet of orientation `sign` != 0 whose box has voxels. Up to 32 voxels of
/// extent the normals are exact in double, beyond they are made of integers.
TETVDB_HD inline void preparePlanes(const LatticePoint (&v)[4], int sign, const TetBox& box,
                                    TetPlanes& t) {
  t.sign = sign;
  for (int k = 0; k < 3; ++k) {
    t.min[k] = static_cast<i32>(box.min[k]);
    t.max[k] = static_cast<i32>(box.max[k]);
  }
  const LatticeBox corners = boxOf(v[0], v[1], v[2], v[3]);
  const double ex = corners.high.x - corners.low.x, ey = corners.high.y - corners.low.y,
               ez = corners.high.z - corners.low.z;
  const bool narrow = corners.extent() <= static_cast<double>(i64(1) << 25);
  const double columnsX = ex * kVoxelsPerUnit + 1, columnsY = ey * kVoxelsPerUnit + 1,
               height = ez * kVoxelsPerUnit + 256;
  const double first[3] = {static_cast<double>(t.min[0]), static_cast<double>(t.min[1]),
                           static_cast<double>(t.min[2])};
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int i = 0; i < 4; ++i) {
    const LatticePoint &a = v[inwardCorner(i, 0)], &b = v[inwardCorner(i, 1)],
                       &c = v[inwardCorner(i, 2)];
    double nx, ny, nz;
    if (narrow) {
      const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
      const double wx = c.x - a.x, wy = c.y - a.y, wz = c.z - a.z;
      nx = uy * wz - uz * wy;
      ny = uz * wx - ux * wz;
      nz = ux * wy - uy * wx;
    } else {
      const ExactVector e = triangleNormal(a, b, c);
      nx = static_cast<double>(e.x);
      ny = static_cast<double>(e.y);
      nz = static_cast<double>(e.z);
    }
    if (sign < 0) {
      nx = -nx;
      ny = -ny;
      nz = -nz;
    }
    const double fromX = first[0] - a.x * kVoxelsPerUnit, fromY = first[1] - a.y * kVoxelsPerUnit;
    // With u = 2^-53 and M the sum of sizes below, slopes have an error of 3 u each, and the
    // products and sums of a crossing add up to 15 u M; 2^-48 leaves a factor of two. 256: the
    // crossing is taken relative to a leaf that is at most so far from the box.
    constexpr double kError = 1.0 / static_cast<double>(i64(1) << 48);
    if (nz == 0) {
      t.side[i] = Side::Vertical;
      t.slopeX[i] = nx;
      t.slopeY[i] = ny;
      t.base[i] = nx * fromX + ny * fromY;
      t.tolerance[i] = (absolute(nx) * columnsX + absolute(ny) * columnsY) * kError;
      continue;
    }
    t.side[i] = nz > 0 ? Side::Lower : Side::Upper;
    const double inverse = -1 / nz;
    t.slopeX[i] = nx * inverse;
    t.slopeY[i] = ny * inverse;
    t.base[i] = (a.z * kVoxelsPerUnit - first[2]) + t.slopeX[i] * fromX + t.slopeY[i] * fromY;
    const double error =
        (absolute(t.slopeX[i]) * columnsX + absolute(t.slopeY[i]) * columnsY + height) * kError;
    t.tolerance[i] = error < kSteep ? error : kNever;
  }
}

/// Normal of a face, inward for a positive tet, and a corner of it.
TETVDB_HD inline ExactVector exactNormal(const TetSource& source, int face, LatticePoint& corner) {
  corner = source.points[source.corners[inwardCorner(face, 0)]];
  return triangleNormal(corner, source.points[source.corners[inwardCorner(face, 1)]],
                        source.points[source.corners[inwardCorner(face, 2)]]);
}

// As tetvdb::exactBound(), of a face of a tet of orientation `sign`.
TETVDB_HD TETVDB_APART inline i64 exactBound(const TetSource& source, int sign, int face,
                                             bool steep, i64 x, i64 y, i64 zNear) {
  LatticePoint a;
  ExactVector n = exactNormal(source, face, a);
  if (sign < 0)
    n = {-n.x, -n.y, -n.z};
  return tetvdb::exactBound(n, a, steep, x, y, zNear);
}

// Whether column (x, y) lies inside a face that is parallel to z, by integers.
TETVDB_HD TETVDB_APART inline bool exactInside(const TetSource& source, int sign, int face, i64 x,
                                               i64 y) {
  LatticePoint a;
  const ExactVector n = exactNormal(source, face, a);
  int side = signOf(n.x * unitsFrom(a.x, x) + n.y * unitsFrom(a.y, y));
  if (side == 0)
    side = tieSign(n.x, n.y, n.z);
  return side == sign;
}

/// Nearest integer, |v| < 2^31, as a number and as a double.
TETVDB_HD inline i32 nearestOf(double v, double& nearest) {
  constexpr double kRound = 6755399441055744.0; // 1.5 * 2^52
  const double shifted = v + kRound;
  nearest = shifted - kRound;
#if defined(__CUDA_ARCH__)
  return __double2loint(shifted);
#else
  return static_cast<i32>(nearest);
#endif
}

/// The voxels z0 + lo <= z < z0 + hi of the column at (dx, dy) from the box's first that the tet
/// owns, 0 <= lo, hi <= span; false where there are none. `rows`: base + slopeX dx of every face.
/// The column and z0 must be in or beside the tet's box.
TETVDB_HD inline bool ownedRun(const TetPlanes& t, const TetSource& source, const double (&rows)[4],
                               int dx, int dy, i32 z0, int span, int& lo, int& hi) {
  int first = 0, end = span;
  const double low = -4.5, high = static_cast<double>(span) + 4.5;
  const double shift = static_cast<double>(t.min[2] - z0), column = static_cast<double>(dy);
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int i = 0; i < 4; ++i) {
    const double value = rows[i] + t.slopeY[i] * column;
    if (t.side[i] == Side::Vertical) {
      bool inside = value > 0;
      if (absolute(value) <= t.tolerance[i])
        inside = exactInside(source, t.sign, i, i64(t.min[0]) + dx, i64(t.min[1]) + dy);
      if (!inside)
        return false;
      continue;
    }
    double nearest;
    const double crossing = minOf(maxOf(value + shift, low), high);
    i32 z = nearestOf(crossing, nearest);
    if (absolute(crossing - nearest) <= t.tolerance[i]) {
      const bool steep = t.tolerance[i] == kNever;
      const i64 exact = exactBound(source, t.sign, i, steep, i64(t.min[0]) + dx, i64(t.min[1]) + dy,
                                   steep ? i64(z0) : i64(z0) + z) -
                        z0;
      z = static_cast<i32>(exact < -4 ? -4 : exact > span + 4 ? span + 4 : exact);
    } else {
      z += crossing > nearest ? 1 : 0;
    }
    if (t.side[i] == Side::Lower)
      first = z > first ? z : first;
    else
      end = z < end ? z : end;
  }
  lo = first;
  hi = end;
  return lo < hi;
}

/// Whether no voxel of a box (inclusive, voxels) can be the tet's. Conservative: true is certain.
TETVDB_HD inline bool outsideBox(const TetPlanes& t, const i64 (&min)[3], const i64 (&max)[3]) {
  const double x0 = static_cast<double>(min[0] - t.min[0]),
               x1 = static_cast<double>(max[0] - t.min[0]),
               y0 = static_cast<double>(min[1] - t.min[1]),
               y1 = static_cast<double>(max[1] - t.min[1]),
               z0 = static_cast<double>(min[2] - t.min[2]),
               z1 = static_cast<double>(max[2] - t.min[2]);
  for (int i = 0; i < 4; ++i) {
    if (t.tolerance[i] == kNever && t.side[i] != Side::Vertical)
      continue;
    const double ax = t.slopeX[i] * x0, bx = t.slopeX[i] * x1, ay = t.slopeY[i] * y0,
                 by = t.slopeY[i] * y1;
    if (t.side[i] == Side::Lower) {
      if (t.base[i] + minOf(ax, bx) + minOf(ay, by) - t.tolerance[i] > z1)
        return true;
    } else {
      const double top = t.base[i] + maxOf(ax, bx) + maxOf(ay, by) + t.tolerance[i];
      if (top < (t.side[i] == Side::Upper ? z0 : 0))
        return true;
    }
  }
  return false;
}

} // namespace tetvdb::nano
