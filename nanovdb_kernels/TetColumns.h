// SPDX-License-Identifier: Apache-2.0
//
// The voxels of a z column that a tet owns, exactly: the rule of voxelize/Ownership.h by columns,
// as voxelize/TetRaster.h has it, in a form for the device.
#pragma once

#include "FaceColumns.h"

namespace tetvdb::nano {

/// How a face of a tet bounds the columns.
enum class Side : u8 { Lower, Upper, Vertical };

struct TetColumns {
  LatticePoint v[4];
  double slopeX[4], slopeY[4]; // of the face opposite to vertex i
  double tolerance[4];         // voxels; bound on the error of a crossing at the tet's columns
  Side side[4];
  i32 sign; // orientation; 0: flat, owns nothing
};

/// Inclusive box of the voxel centres within a tet's box.
struct VoxelBounds {
  i64 min[3], max[3];
  TETVDB_HD bool empty() const { return min[0] > max[0] || min[1] > max[1] || min[2] > max[2]; }
};

// The corners of the face opposite to vertex i: for a positive tet the normal points inward.
TETVDB_HD constexpr int faceCorner(int face, int k) {
  constexpr int corners[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
  return corners[face][k];
}

/// Orientation by doubles where these decide (Shewchuk 1997, orient3d's first filter: differences
/// are exact here), else by integers.
TETVDB_HD inline int tetSign(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
                             const LatticePoint& d) {
  const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
  const double vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
  const double wx = d.x - a.x, wy = d.y - a.y, wz = d.z - a.z;
  const double xy = vx * wy, yx = vy * wx, yz = vy * wz, zy = vz * wy, zx = vz * wx, xz = vx * wz;
  const double det = ux * (yz - zy) + uy * (zx - xz) + uz * (xy - yx);
  const double permanent = magnitude(ux) * (magnitude(yz) + magnitude(zy)) +
                           magnitude(uy) * (magnitude(zx) + magnitude(xz)) +
                           magnitude(uz) * (magnitude(xy) + magnitude(yx));
  if (magnitude(det) > 1e-15 * permanent)
    return det > 0 ? 1 : -1;
  return signOf(orientation(a, b, c, d));
}

TETVDB_HD inline double tetExtent(const LatticePoint (&v)[4]) {
  const auto along = [](double a, double b, double c, double d) {
    return most(most(a, b), most(c, d)) - least(least(a, b), least(c, d));
  };
  return most(along(v[0].x, v[1].x, v[2].x, v[3].x), along(v[0].y, v[1].y, v[2].y, v[3].y),
              along(v[0].z, v[1].z, v[2].z, v[3].z));
}

TETVDB_HD inline VoxelBounds boundsOf(const LatticePoint (&v)[4]) {
  VoxelBounds b;
  b.min[0] = ceilVoxel(least(least(v[0].x, v[1].x), least(v[2].x, v[3].x)));
  b.max[0] = floorVoxel(most(most(v[0].x, v[1].x), most(v[2].x, v[3].x)));
  b.min[1] = ceilVoxel(least(least(v[0].y, v[1].y), least(v[2].y, v[3].y)));
  b.max[1] = floorVoxel(most(most(v[0].y, v[1].y), most(v[2].y, v[3].y)));
  b.min[2] = ceilVoxel(least(least(v[0].z, v[1].z), least(v[2].z, v[3].z)));
  b.max[2] = floorVoxel(most(most(v[0].z, v[1].z), most(v[2].z, v[3].z)));
  return b;
}

TETVDB_HD inline ExactVector inwardNormal(const TetColumns& t, int face) {
  const ExactVector n =
      triangleNormal(t.v[faceCorner(face, 0)], t.v[faceCorner(face, 1)], t.v[faceCorner(face, 2)]);
  return t.sign > 0 ? n : ExactVector{-n.x, -n.y, -n.z};
}

/// Finds sign and planes; t.v is set. Up to 32 voxels of extent the normals are exact in double,
/// beyond they are made of integers.
TETVDB_HD inline void prepareTet(TetColumns& t) {
  t.sign = tetSign(t.v[0], t.v[1], t.v[2], t.v[3]);
  if (t.sign == 0)
    return;
  const bool narrow = tetExtent(t.v) <= static_cast<double>(i64(1) << 25);
  const auto along = [](double a, double b, double c, double d) {
    return most(most(a, b), most(c, d)) - least(least(a, b), least(c, d));
  };
  const double columnsX = along(t.v[0].x, t.v[1].x, t.v[2].x, t.v[3].x) * kVoxelsPerUnit + 1,
               columnsY = along(t.v[0].y, t.v[1].y, t.v[2].y, t.v[3].y) * kVoxelsPerUnit + 1,
               height = along(t.v[0].z, t.v[1].z, t.v[2].z, t.v[3].z) * kVoxelsPerUnit + 256;
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int i = 0; i < 4; ++i) {
    const LatticePoint &a = t.v[faceCorner(i, 0)], &b = t.v[faceCorner(i, 1)],
                       &c = t.v[faceCorner(i, 2)];
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
    const double inward = t.sign > 0 ? nz : -nz;
    t.slopeX[i] = t.slopeY[i] = t.tolerance[i] = 0;
    if (inward == 0) {
      t.side[i] = Side::Vertical;
      continue;
    }
    t.side[i] = inward > 0 ? Side::Lower : Side::Upper;
    t.slopeX[i] = -nx / nz;
    t.slopeY[i] = -ny / nz;
    t.tolerance[i] =
        (magnitude(t.slopeX[i]) * columnsX + magnitude(t.slopeY[i]) * columnsY + height) *
        (1.0 / static_cast<double>(i64(1) << 49));
  }
}

// First voxel of column (x, y) beyond the plane: the first inside for a lower bound, the first
// outside for an upper one; by integers, see TetRaster.cpp.
TETVDB_HD inline i64 exactBound(const TetColumns& t, int face, i64 x, i64 y, i64 zNear) {
  const ExactVector n = inwardNormal(t, face);
  const LatticePoint& o = t.v[faceCorner(face, 0)];
  const Int128 planar = n.x * unitsFrom(o.x, x) + n.y * unitsFrom(o.y, y);
  const bool tieIn = tieSign(n.x, n.y, n.z) > 0;
  const bool lower = n.z > 0;
  if (t.tolerance[face] < kSteep) {
    const int sign = signOf(planar + n.z * unitsFrom(o.z, zNear));
    const bool inside = sign > 0 || (sign == 0 && tieIn);
    return inside == lower ? zNear : zNear + 1;
  }
  const Int128 oz = -unitsFrom(o.z, zNear);
  const Int128 step = (lower ? n.z : -n.z) * kUnitsPerVoxel;
  const Int128 num = lower ? n.z * oz - planar : planar - n.z * oz;
  return zNear +
         static_cast<i64>(lower == tieIn ? ceilDivide(num, step) : floorDivide(num, step) + 1);
}

// Whether column (x, y) lies inside a face that is parallel to z.
TETVDB_HD inline bool insideVertical(const TetColumns& t, int face, i64 x, i64 y) {
  const LatticePoint &a = t.v[faceCorner(face, 0)], &b = t.v[faceCorner(face, 1)],
                     &c = t.v[faceCorner(face, 2)];
  const ExactVector n = triangleNormal(a, b, c);
  const Int128 value = n.x * unitsFrom(a.x, x) + n.y * unitsFrom(a.y, y);
  int side = signOf(value);
  if (side == 0)
    side = tieSign(n.x, n.y, n.z);
  return side == t.sign;
}

/// The voxels z0 + lo <= z < z0 + hi of column (x, y) that the tet owns, 0 <= lo, hi <= span; false
/// where there are none. The column and z0 must be in or beside the tet's box.
TETVDB_HD inline bool ownedRun(const TetColumns& t, i64 x, i64 y, i64 z0, int span, int& lo,
                               int& hi) {
  i64 first = 0, end = span;
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int i = 0; i < 4; ++i) {
    if (t.side[i] == Side::Vertical) {
      if (!insideVertical(t, i, x, y))
        return false;
      continue;
    }
    const LatticePoint& o = t.v[faceCorner(i, 0)];
    const double crossing = (o.z - static_cast<double>(z0) * kUnits) * kVoxelsPerUnit +
                            t.slopeX[i] * (static_cast<double>(x) - o.x * kVoxelsPerUnit) +
                            t.slopeY[i] * (static_cast<double>(y) - o.y * kVoxelsPerUnit);
    i64 z;
    if (t.tolerance[i] >= kSteep) {
      z = exactBound(t, i, x, y, z0) - z0;
    } else if (crossing < -2) {
      z = -1;
    } else if (crossing > span + 2) {
      z = span + 1;
    } else {
      const double nearest = rint(crossing);
      if (magnitude(crossing - nearest) <= t.tolerance[i])
        z = exactBound(t, i, x, y, z0 + static_cast<i64>(nearest)) - z0;
      else
        z = static_cast<i64>(nearest) + (crossing > nearest ? 1 : 0);
    }
    if (t.side[i] == Side::Lower)
      first = z > first ? z : first;
    else
      end = z < end ? z : end;
  }
  lo = static_cast<int>(first < span ? first : span);
  hi = static_cast<int>(end > 0 ? end : 0);
  return lo < hi;
}

/// Whether no voxel of the box x0.., y0.., z0.. (inclusive) can be the tet's. Conservative: true is
/// certain.
TETVDB_HD inline bool outsideBox(const TetColumns& t, const i64 (&min)[3], const i64 (&max)[3]) {
  for (int i = 0; i < 4; ++i) {
    const LatticePoint &a = t.v[faceCorner(i, 0)], &b = t.v[faceCorner(i, 1)],
                       &c = t.v[faceCorner(i, 2)];
    const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
    const double wx = c.x - a.x, wy = c.y - a.y, wz = c.z - a.z;
    // Each component has an error of at most 2^-52 of its two products' sizes.
    const double n[3] = {uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx};
    const double sizes[3] = {magnitude(uy * wz) + magnitude(uz * wy),
                             magnitude(uz * wx) + magnitude(ux * wz),
                             magnitude(ux * wy) + magnitude(uy * wx)};
    const double origin[3] = {a.x, a.y, a.z};
    double best = 0, size = 0;
    for (int k = 0; k < 3; ++k) {
      const double inward = t.sign > 0 ? n[k] : -n[k];
      const double low = static_cast<double>(min[k]) * kUnits - origin[k];
      const double high = static_cast<double>(max[k]) * kUnits - origin[k];
      best += inward * (inward > 0 ? high : low);
      size += sizes[k] * (magnitude(low) + magnitude(high));
    }
    if (best < -1e-14 * size)
      return true;
  }
  return false;
}

} // namespace tetvdb::nano
