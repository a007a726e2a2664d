// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/complex/PointStar.h"
#include "tetvdb/tetrahedralize/complex/SurfaceBounds.h"
#include "tetvdb/tetrahedralize/complex/SurfaceGuard.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// Moves points of one part, serially, to where the tets around them are better.
class PointSmoother {
public:
  /// Bit of Point::changed.
  static constexpr std::uint8_t kChanged = 4;

  /// Only points with tets above `energy` move. Points of the surface move on the input; where that
  /// does not help and there are tets above `freeEnergy`, they may leave it, within bounds.
  PointSmoother(TetComplex& complex, const Bounds& bounds, double energy, double freeEnergy)
      : complex_(complex), bounds_(bounds), energy_(energy), freeEnergy_(freeEnergy),
        guard_(bounds) {}

  /// Tries every such point around which something changed since it was last tried without success.
  /// No tet gets worse than the worst around the point, and the sum of cubed energies decreases.
  /// Returns how many points moved.
  std::size_t sweep();

  std::size_t tried() const { return tried_; }

private:
  bool smooth(std::uint32_t point);
  void project(Vec3d& at, double reach) const;
  bool keepsBounds(const Vec3d& at);

  TetComplex& complex_;
  const Bounds& bounds_;
  const double energy_, freeEnergy_;
  std::size_t tried_ = 0;
  PointStar star_;
  SurfaceGuard guard_;
  std::array<std::uint32_t, 2> boundaryNeighbours_{}; // the neighbours along the boundary edges
  bool onBoundary_ = false;
};

} // namespace tetvdb
