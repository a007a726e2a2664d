// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/complex/PointStar.h"
#include "tetvdb/tetrahedralize/complex/SurfaceGuard.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Moves bad tets at the surface of one part to the outside, where their weight is less: tets that
/// are flat against the surface, whose shape no other operation can change because their faces are
/// tracked. Serial. The surface keeps its topology and stays within bounds.
class TetPeeler {
public:
  /// Bit of Point::changed.
  static constexpr std::uint8_t kChanged = 16;

  /// Only tets above `energy` are moved.
  TetPeeler(TetComplex& complex, const Bounds& bounds, double energy)
      : complex_(complex), bounds_(bounds), energy_(energy), guard_(bounds) {}

  /// Tries every such tet around which something changed since it was last tried, the worst first.
  /// Returns how many were moved.
  std::size_t sweep();

private:
  enum class Answer { No, NotHere, Yes };

  Answer mayGo(std::uint32_t t);
  Answer keepsTopology(std::uint32_t t, std::size_t trackedCount) const;
  bool keepsBounds(const TetComplex::Tet& tet);

  TetComplex& complex_;
  const Bounds& bounds_;
  const double energy_;
  SurfaceGuard guard_;
  std::vector<Landmarks::Face> before_, after_;
  mutable std::vector<std::uint32_t> star_;
  float beyond_ = 1; // the weight there
};

} // namespace tetvdb
