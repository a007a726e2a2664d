// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/complex/PointStar.h"
#include "tetvdb/tetrahedralize/complex/SurfaceBounds.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Whether tracked faces may change: the new faces stay in the envelope, and the old ones stay near
/// the new ones, so that spikes are not removed.
class SurfaceGuard {
public:
  explicit SurfaceGuard(const Bounds& bounds) : bounds_(bounds) {}

  /// For the tracked faces around the star's point when it moves to `to`; those with corner
  /// `vanishes` are removed. The old point, the midpoints of old edges, and landmarks have to stay
  /// near.
  bool allows(const TetComplex& complex, const PointStar& star, const Vec3d& to,
              std::uint32_t vanishes = TetComplex::kNone);

  /// For the tracked faces (a, b, c) and (a, b, d) that are replaced by (a, c, d) and (b, c, d).
  bool allowsFlip(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

  /// For tracked faces `before` that are replaced by `after`, the other faces of the same flat tet
  /// or tets; these are no farther from them than the radius.
  bool allowsExchange(const std::vector<Landmarks::Face>& before,
                      const std::vector<Landmarks::Face>& after) const;

private:
  const Bounds& bounds_;
  std::vector<std::array<Vec3d, 2>> sheets_; // with `to`
  std::vector<Landmarks::Face> before_, after_;
};

} // namespace tetvdb
