// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/SurfaceGuard.h"

#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/geometry/VectorMath.h"

namespace tetvdb {

bool SurfaceGuard::allows(const TetComplex& complex, const PointStar& star, const Vec3d& to,
                          std::uint32_t vanishes) {
  sheets_.clear();
  for (const PointStar::Sheet& sheet : star.sheets())
    if (sheet.p != vanishes && sheet.q != vanishes)
      sheets_.push_back({complex.at(sheet.p), complex.at(sheet.q)});
  const double square = bounds_.radius * bounds_.radius;
  const auto isNear = [&](const Vec3d& p) {
    for (const auto& [a, b] : sheets_)
      if (nearestOnTriangle(minus(to, p), minus(a, p), minus(b, p)).squared <= square)
        return true;
    return false;
  };
  const Vec3d& from = complex.at(star.point());
  if (!isNear(from))
    return false;
  for (const PointStar::Spoke& spoke : star.spokes())
    if (spoke.sheets > 0 && spoke.point != vanishes &&
        !isNear(times(plus(from, complex.at(spoke.point)), 0.5)))
      return false;
  for (const auto& [a, b] : sheets_)
    if (!bounds_.surface.contains(to, a, b, bounds_.radius))
      return false;
  if (bounds_.landmarks == nullptr)
    return true;
  before_.clear();
  after_.clear();
  for (const PointStar::Sheet& sheet : star.sheets())
    before_.push_back({from, complex.at(sheet.p), complex.at(sheet.q)});
  for (const auto& [a, b] : sheets_)
    after_.push_back({to, a, b});
  return bounds_.landmarks->keeps(before_, after_);
}

bool SurfaceGuard::allowsFlip(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  // Of the old faces the old edge is farthest from the new ones.
  for (const double s : {0.5, 0.25, 0.75}) {
    const Vec3d p = plus(times(a, 1 - s), times(b, s));
    if (nearestOnTriangle(minus(a, p), minus(c, p), minus(d, p)).squared >
            bounds_.radius * bounds_.radius &&
        nearestOnTriangle(minus(b, p), minus(c, p), minus(d, p)).squared >
            bounds_.radius * bounds_.radius)
      return false;
  }
  if (!bounds_.surface.contains(a, c, d, bounds_.radius) ||
      !bounds_.surface.contains(b, c, d, bounds_.radius))
    return false;
  if (bounds_.landmarks == nullptr)
    return true;
  before_.assign({{a, b, c}, {a, b, d}});
  after_.assign({{a, c, d}, {b, c, d}});
  return bounds_.landmarks->keeps(before_, after_);
}

bool SurfaceGuard::allowsExchange(const std::vector<Landmarks::Face>& before,
                                  const std::vector<Landmarks::Face>& after) const {
  for (const auto& [a, b, c] : after)
    if (!bounds_.surface.contains(a, b, c, bounds_.radius))
      return false;
  return bounds_.landmarks == nullptr || bounds_.landmarks->keeps(before, after);
}

} // namespace tetvdb
