// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/SurfaceGuard.h"

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
  return true;
}

} // namespace tetvdb
