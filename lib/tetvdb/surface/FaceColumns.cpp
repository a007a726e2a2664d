// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/FaceColumns.h"

#include "tetvdb/geometry/Exact.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tetvdb {
namespace {

// Error of values with fewer than 16 roundings, relative to the sum of the absolute terms.
constexpr double kRoundings = 0x1p-48;

// The orientation of a, b and the point, seen along its axis. Differences are exact: 48 bits.
int turn(const Vec3d& a, const Vec3d& b, const LiftedPoint& point) {
  const std::size_t p = (point.axis() + 1) % 3, q = (point.axis() + 2) % 3;
  const Vec3d& at = point.position();
  const double ap = a[p] - at[p], aq = a[q] - at[q], bp = b[p] - at[p], bq = b[q] - at[q];
  const double left = ap * bq, right = aq * bp;
  if (std::abs(left - right) > kRoundings * (std::abs(left) + std::abs(right)))
    return signOf(left - right);
  const auto fine = [](double d) {
    return Int128(static_cast<std::int64_t>(d * (1 << kFineBits)));
  };
  return signOf(fine(ap) * fine(bq) - fine(aq) * fine(bp));
}

// The side of a face's plane that the point is on, in doubles; 0 if uncertain.
int roughSide(const std::array<Vec3d, 3>& c, const LiftedPoint& point) {
  const Vec3d u = minus(c[1], c[0]), v = minus(c[2], c[0]), w = minus(point.position(), c[0]);
  double value = 0, max = 0, alongAxis = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t p = (k + 1) % 3, q = (k + 2) % 3;
    const double left = u[p] * v[q], right = u[q] * v[p];
    const double size = std::abs(left) + std::abs(right);
    value += (left - right) * w[k];
    max += size * std::abs(w[k]);
    if (k == point.axis())
      alongAxis = size;
  }
  // The point's own coordinate is rounded, and so is its difference.
  const double error = 2 * point.error() + 0x1p-50 * std::abs(point.position()[point.axis()]);
  return std::abs(value) > kRoundings * max + alongAxis * error ? signOf(value) : 0;
}

} // namespace

std::optional<SideWindings> FaceColumns::at(const FacePlanes& face, const LiftedPoint& point,
                                            std::size_t& looked) const {
  const std::size_t axis = point.axis();
  Vec3d from = point.position();
  from[axis] -= point.error() + 1;
  std::int64_t above = 0, here = 0;
  auto firstHere = static_cast<std::uint32_t>(welded_.faces.size());
  bool tie = false;
  boxes_.above(axis, from, [&](std::uint32_t other) {
    ++looked;
    const std::array<Vec3d, 3> c = welded_.cornersOf(other);
    const int first = turn(c[0], c[1], point), second = turn(c[1], c[2], point),
              third = turn(c[2], c[0], point);
    const int min = std::min({first, second, third}), max = std::max({first, second, third});
    if (min < 0 && max > 0)
      return false;
    tie = min == 0 || max == 0;
    if (tie)
      return true;
    const std::int64_t crossing = min * std::int64_t(welded_.faces[other].weight);
    int side = roughSide(c, point);
    if (side == 0) {
      const LatticePlane plane = LatticePlane::through(c[0], c[1], c[2]);
      side = point.side(plane);
      if (side == 0) {
        here += crossing;
        firstHere = std::min(firstHere, other);
        tie = !plane.coincides(face.plane);
        return tie;
      }
    }
    // Below its plane: the normal's component along the axis has the sign of the orientations.
    if (side * min < 0)
      above += crossing;
    return false;
  });
  if (tie)
    return std::nullopt;
  const bool frontIsUp = face.plane.n[axis] > 0;
  return SideWindings{frontIsUp ? above : above + here, frontIsUp ? above + here : above,
                      firstHere};
}

} // namespace tetvdb
