// SPDX-License-Identifier: Apache-2.0
//
// The mesher's coordinates: whole numbers, stored in doubles.
//
// The model's box is mapped onto a lattice whose unit is a power of two, fine enough for 48 bits
// along the longest side (about 4e-15 of it), and no finer than doubles resolve at the model's
// distance from the origin. Differences of coordinates are then exact in doubles, orientations are
// exact in 192 bits, and the way back to world space rounds nothing: a tet that is positive on the
// lattice is positive in the file.
//   The soup's points lie on every 1024th point of it at most, so that insertion can add
// points between faces that almost touch.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/Exact.h"
#include "tetvdb/geometry/RoundedDeterminant.h"

#include <cmath>
#include <cstdint>

namespace tetvdb {

/// The absolute values of lattice points' coordinates are below this.
constexpr double kLatticeBound = static_cast<double>(std::int64_t(1) << 47);

class WorkingLattice {
public:
  /// For points within `box` (world space, not empty); leaves room for a margin as wide as half
  /// the box's longest side all around.
  explicit WorkingLattice(const Box& box);

  double unit() const { return unit_; } ///< world units: a power of two
  /// Lattice units, a power of two: the multiples of it have 38 bits along the longest side, few
  /// enough for exact spheres (InSphere.h).
  double coarse() const { return coarse_; }
  /// The nearest lattice point.
  Vec3d toLattice(const Vec3d& world) const;
  /// Exact.
  Vec3d toWorld(const Vec3d& lattice) const;

private:
  Vec3d origin_; // a lattice point of the lattice about 0
  double unit_, coarse_;
};

/// To the nearest lattice point.
inline Vec3d roundToLattice(const Vec3d& p) {
  return {std::nearbyint(p[0]), std::nearbyint(p[1]), std::nearbyint(p[2])};
}

/// To the nearest lattice point that is a multiple of `grain`, a power of two.
inline Vec3d roundToGrain(const Vec3d& p, double grain) {
  const Vec3d whole = roundToLattice({p[0] / grain, p[1] / grain, p[2] / grain});
  return {whole[0] * grain, whole[1] * grain, whole[2] * grain};
}

/// Six times the signed volume of the tet a, b, c, d of lattice points: the exact value,
/// rounded to 2^-52 of it, so that its sign is exact.
double exactDeterminant(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

/// Six times the signed volume of the tet a, b, c, d, rounded: above 0 where d lies on the side
/// that (b - a) x (c - a) points to.
inline double orientDeterminant(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
  const double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
  const double wx = d[0] - a[0], wy = d[1] - a[1], wz = d[2] - a[2];
  return wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx);
}

/// The sign of the tet's volume, exact for lattice points.
inline int latticeOrientation(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const RoundedDeterminant rounded(b[0] - a[0], b[1] - a[1], b[2] - a[2], c[0] - a[0], c[1] - a[1],
                                   c[2] - a[2], d[0] - a[0], d[1] - a[1], d[2] - a[2]);
  const int sign = rounded.sign(RoundedDeterminant::kOfExact);
  return sign != 0 ? sign : signOf(exactDeterminant(a, b, c, d));
}

} // namespace tetvdb
