// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/LatticePlane.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/geometry/WideInteger.h"

#include <cmath>

namespace tetvdb {
namespace {

// Determinants of four planes are sums of products of three normals' components (2^81 each) and one
// d (2^123): below 2^371.
using Wide = WideInteger<6>;
// A plane at a fine point, times a normal's component: below 2^216.
using WideLift = WideInteger<4>;

// Every value here is a sum of products that passes through fewer than 16 roundings.
constexpr double kRoundings = 0x1p-48;

Vec3d absolutes(const Vec3d& a) {
  return {std::abs(a[0]), std::abs(a[1]), std::abs(a[2])};
}

// cross() of absolute values, with all products added.
Vec3d crossMax(const Vec3d& a, const Vec3d& b) {
  return {a[1] * b[2] + a[2] * b[1], a[2] * b[0] + a[0] * b[2], a[0] * b[1] + a[1] * b[0]};
}

std::array<Wide, 3> wideCross(const LatticePlane& a, const LatticePlane& b) {
  std::array<Wide, 3> result;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t p = (k + 1) % 3, q = (k + 2) % 3;
    result[k] = Wide(a.n[p]) * Wide(b.n[q]) - Wide(a.n[q]) * Wide(b.n[p]);
  }
  return result;
}

struct WideCorner {
  std::array<Wide, 3> x;
  Wide w;
};

WideCorner wideCorner(const std::array<const LatticePlane*, 3>& planes) {
  const LatticePlane &a = *planes[0], &b = *planes[1], &c = *planes[2];
  const std::array<Wide, 3> bc = wideCross(b, c), ca = wideCross(c, a), ab = wideCross(a, b);
  WideCorner corner;
  corner.w = Wide(a.n[0]) * bc[0] + Wide(a.n[1]) * bc[1] + Wide(a.n[2]) * bc[2];
  for (std::size_t k = 0; k < 3; ++k)
    corner.x[k] = -(Wide(a.d) * bc[k] + Wide(b.d) * ca[k] + Wide(c.d) * ab[k]);
  return corner;
}

Int128 integer(double lattice) {
  return static_cast<std::int64_t>(lattice);
}

} // namespace

void LatticePlane::round() {
  for (std::size_t k = 0; k < 3; ++k)
    roundedN[k] = static_cast<double>(n[k]);
  roundedD = static_cast<double>(d);
}

LatticePlane LatticePlane::through(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  LatticePlane plane;
  const Vec3d u = minus(b, a), v = minus(c, a);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t p = (k + 1) % 3, q = (k + 2) % 3;
    plane.n[k] = integer(u[p]) * integer(v[q]) - integer(u[q]) * integer(v[p]);
    plane.d -= plane.n[k] * integer(a[k]);
  }
  plane.round();
  return plane;
}

LatticePlane LatticePlane::alongAxis(const Vec3d& a, const Vec3d& b, std::size_t axis,
                                     const Vec3d& inner) {
  LatticePlane plane;
  const std::size_t p = (axis + 1) % 3, q = (axis + 2) % 3;
  plane.n[p] = integer(b[q] - a[q]);
  plane.n[q] = -integer(b[p] - a[p]);
  plane.d = -(plane.n[p] * integer(a[p]) + plane.n[q] * integer(a[q]));
  if (plane.n[p] * integer(inner[p]) + plane.n[q] * integer(inner[q]) + plane.d < 0) {
    plane.n[p] = -plane.n[p];
    plane.n[q] = -plane.n[q];
    plane.d = -plane.d;
  }
  plane.round();
  return plane;
}

std::size_t LatticePlane::steepestAxis() const {
  const auto absolute = [&](std::size_t k) { return n[k] < 0 ? -n[k] : n[k]; };
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (absolute(k) > absolute(axis))
      axis = k;
  return axis;
}

int LatticePlane::side(const Vec3d& p) const {
  const double value = dot(roundedN, p) + roundedD;
  const double max = dot(absolutes(roundedN), p) + std::abs(roundedD);
  if (std::abs(value) > kRoundings * max)
    return signOf(value);
  return signOf(n[0] * integer(p[0]) + n[1] * integer(p[1]) + n[2] * integer(p[2]) + d);
}

bool LatticePlane::coincides(const LatticePlane& other) const {
  const Vec3d rough = tetvdb::cross(roundedN, other.roundedN);
  const Vec3d max = crossMax(absolutes(roundedN), absolutes(other.roundedN));
  for (std::size_t k = 0; k < 3; ++k)
    if (std::abs(rough[k]) > kRoundings * max[k])
      return false;
  for (const Wide& w : wideCross(*this, other))
    if (w.sign() != 0)
      return false;
  const std::size_t axis = steepestAxis();
  return (Wide(n[axis]) * Wide(other.d) - Wide(other.n[axis]) * Wide(d)).sign() == 0;
}

PlaneCorner::PlaneCorner(const Vec3d& latticePoint) : x_(latticePoint), maxX_(latticePoint) {}

PlaneCorner::PlaneCorner(const LatticePlane& a, const LatticePlane& b, const LatticePlane& c)
    : planes_{&a, &b, &c} {
  const Vec3d bc = cross(b.roundedN, c.roundedN), ca = cross(c.roundedN, a.roundedN),
              ab = cross(a.roundedN, b.roundedN);
  const Vec3d na = absolutes(a.roundedN), nb = absolutes(b.roundedN), nc = absolutes(c.roundedN);
  const Vec3d maxBc = crossMax(nb, nc), maxCa = crossMax(nc, na), maxAb = crossMax(na, nb);
  w_ = dot(a.roundedN, bc);
  maxW_ = dot(na, maxBc);
  for (std::size_t k = 0; k < 3; ++k) {
    x_[k] = -(a.roundedD * bc[k] + b.roundedD * ca[k] + c.roundedD * ab[k]);
    maxX_[k] = std::abs(a.roundedD) * maxBc[k] + std::abs(b.roundedD) * maxCa[k] +
               std::abs(c.roundedD) * maxAb[k];
  }
  signW_ = std::abs(w_) > kRoundings * maxW_ ? signOf(w_) : wideCorner(planes_).w.sign();
}

int PlaneCorner::side(const LatticePlane& plane) const {
  if (planes_[0] == nullptr)
    return plane.side(x_);
  for (const LatticePlane* own : planes_)
    if (own == &plane)
      return 0;
  const double value = dot(plane.roundedN, x_) + plane.roundedD * w_;
  const double max = dot(absolutes(plane.roundedN), maxX_) + std::abs(plane.roundedD) * maxW_;
  if (std::abs(value) > kRoundings * max)
    return signOf(value) * signW_;
  const WideCorner exact = wideCorner(planes_);
  return (Wide(plane.n[0]) * exact.x[0] + Wide(plane.n[1]) * exact.x[1] +
          Wide(plane.n[2]) * exact.x[2] + Wide(plane.d) * exact.w)
             .sign() *
         signW_;
}

Vec3d PlaneCorner::position() const {
  if (planes_[0] == nullptr)
    return x_;
  const double size = std::abs(w_);
  bool precise = true;
  for (std::size_t k = 0; k < 3; ++k)
    precise = precise && kRoundings * (maxX_[k] + maxW_ * std::abs(x_[k] / w_)) < 0x1p-7 * size;
  if (precise)
    return times(x_, 1 / w_);
  const WideCorner exact = wideCorner(planes_);
  const double w = exact.w.toDouble();
  return {exact.x[0].toDouble() / w, exact.x[1].toDouble() / w, exact.x[2].toDouble() / w};
}

LiftedPoint::LiftedPoint(const LatticePlane& plane, std::size_t axis, std::int64_t u,
                         std::int64_t v)
    : plane_(plane), axis_(axis), u_(u), v_(v) {
  constexpr double kUnit = 1.0 / (1 << kFineBits);
  const std::size_t p = (axis + 1) % 3, q = (axis + 2) % 3;
  at_[p] = static_cast<double>(u) * kUnit;
  at_[q] = static_cast<double>(v) * kUnit;
  const double first = plane.roundedN[p] * at_[p], second = plane.roundedN[q] * at_[q];
  const double steep = plane.roundedN[axis];
  at_[axis] = -(first + second + plane.roundedD) / steep;
  error_ = kRoundings * (std::abs(first) + std::abs(second) + std::abs(plane.roundedD)) /
           std::abs(steep);
}

int LiftedPoint::side(const LatticePlane& plane) const {
  const Vec3d max = absolutes(plane.roundedN);
  const double value = dot(plane.roundedN, at_) + plane.roundedD;
  const double bound =
      kRoundings * (dot(max, absolutes(at_)) + std::abs(plane.roundedD)) + max[axis_] * error_;
  if (std::abs(value) > bound)
    return signOf(value);
  const std::size_t p = (axis_ + 1) % 3, q = (axis_ + 2) % 3;
  const auto apart = [&](const LatticePlane& of) { // all terms except that along the axis
    return WideLift(of.n[p]) * WideLift(u_) + WideLift(of.n[q]) * WideLift(v_) +
           WideLift(of.d) * WideLift(Int128(1) << kFineBits);
  };
  const WideLift exact =
      apart(plane) * WideLift(plane_.n[axis_]) - WideLift(plane.n[axis_]) * apart(plane_);
  return exact.sign() * signOf(plane_.n[axis_]);
}

} // namespace tetvdb
