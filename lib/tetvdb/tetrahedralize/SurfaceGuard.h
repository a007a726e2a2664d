// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/Improve.h"
#include "tetvdb/tetrahedralize/PointStar.h"
#include "tetvdb/tetrahedralize/TetComplex.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Whether tracked faces may change, in both directions: they stay in the envelope, and what was
/// there stays near to them, so that spikes and the like are not worn away.
class SurfaceGuard {
public:
  explicit SurfaceGuard(const Bounds& bounds) : bounds_(bounds) {}

  /// For the tracked faces around the star's point when it goes to `to`, those with corner
  /// `vanishes` going for good. The old point and the middles of old edges have to be near, and
  /// landmarks.
  bool allows(const TetComplex& complex, const PointStar& star, const Vec3d& to,
              std::uint32_t vanishes = TetComplex::kNone);

  /// For the tracked faces (a, b, c) and (a, b, d) that give way to (a, c, d) and (b, c, d).
  bool allowsFlip(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

  /// For tracked faces `before` that give way to `after`, the other faces of the same flat tet or
  /// tets; these are no farther from them than the radius.
  bool allowsExchange(const std::vector<Landmarks::Face>& before,
                      const std::vector<Landmarks::Face>& after) const;

private:
  const Bounds& bounds_;
  std::vector<std::array<Vec3d, 2>> sheets_; // with `to`
  std::vector<Landmarks::Face> before_, after_;
};

} // namespace tetvdb
