// SPDX-License-Identifier: Apache-2.0
//
// Planes through lattice points, and points represented by three intersecting planes. Every query
// about such a point is the sign of a determinant of the planes, so that nothing is rounded in
// repeated cuts (Sugihara and Iri 1989; Bernstein and Fussell 2009).
//
// Coordinates are integers of 0 to 2^40 (kMaxPlaneExtent).
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/Exact.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace tetvdb {

constexpr double kMaxPlaneExtent = static_cast<double>(std::int64_t(1) << 40);

/// The points p with n . p + d = 0: components of n are at most 2^81, d at most 2^123.
struct LatticePlane {
  std::array<Int128, 3> n{};
  Int128 d = 0;
  Vec3d roundedN{};
  double roundedD = 0;

  /// Through a, b, c, with the normal toward the side that sees them counter-clockwise. n is 0 if
  /// they are collinear.
  static LatticePlane through(const Vec3d& a, const Vec3d& b, const Vec3d& c);
  /// Through a and b and parallel to `axis`, with `inner` on its positive side or on it.
  static LatticePlane alongAxis(const Vec3d& a, const Vec3d& b, std::size_t axis,
                                const Vec3d& inner);

  /// The axis along which the normal is largest.
  std::size_t steepestAxis() const;
  /// Sign of n . p + d, exact. p must be a lattice point.
  int side(const Vec3d& p) const;
  /// Whether both planes are the same set of points, exact.
  bool coincides(const LatticePlane& other) const;

private:
  void round();
};

/// A lattice point, or the intersection of three planes. Refers to the planes.
class PlaneCorner {
public:
  PlaneCorner() = default;
  explicit PlaneCorner(const Vec3d& latticePoint);
  /// The planes' normals must be independent.
  PlaneCorner(const LatticePlane& a, const LatticePlane& b, const LatticePlane& c);

  /// Its side of `plane`, exact: about 5 ns, and 2 us if doubles do not decide.
  int side(const LatticePlane& plane) const;
  /// Within 2^-6 lattice units.
  Vec3d position() const;

private:
  // Homogeneous: position x / w. `max` bounds the sums of the absolute values of the terms of x and
  // w.
  Vec3d x_{}, maxX_{};
  double w_ = 1, maxW_ = 1;
  int signW_ = 1;
  std::array<const LatticePlane*, 3> planes_{};
};

/// Points of a plane are also represented by two coordinates; the third follows from the plane. The
/// unit is 2^-8 of the lattice's, so that all but the thinnest pieces contain such a point.
constexpr int kFineBits = 8;
class LiftedPoint {
public:
  /// The point of `plane`, whose steepest axis is `axis`, with coordinates u and v along the axes
  /// after `axis`, in fine units.
  LiftedPoint(const LatticePlane& plane, std::size_t axis, std::int64_t u, std::int64_t v);

  std::size_t axis() const { return axis_; }
  std::int64_t u() const { return u_; }
  std::int64_t v() const { return v_; }
  /// In lattice units; exact but along the axis, and there within error().
  const Vec3d& position() const { return at_; }
  double error() const { return error_; }

  /// Its side of another plane, exact.
  int side(const LatticePlane& plane) const;

private:
  const LatticePlane& plane_;
  std::size_t axis_;
  std::int64_t u_, v_;
  Vec3d at_{};
  double error_ = 0;
};

} // namespace tetvdb
