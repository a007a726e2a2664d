// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/complex/EdgeSizes.h"
#include "tetvdb/tetrahedralize/complex/PointStar.h"
#include "tetvdb/tetrahedralize/complex/SurfaceBounds.h"
#include "tetvdb/tetrahedralize/complex/SurfaceGuard.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Collapses edges of one part, serially: a point is removed, and the tets around it get one of its
/// neighbours for a corner instead.
///   The tracked faces keep their topology (the link condition of "Topology preserving edge
/// contraction", Dey, Edelsbrunner, Guha, Nekhayev 1999, for the surface; for tets it holds by
/// itself where all of them are positive): no hole opens, no thin wall is closed. They stay
/// within the envelope, and the removed point stays near them, so that no spike is removed.
class EdgeCollapser {
public:
  struct Rules {
    /// No tet may get worse than this, unless one around the point was.
    double energy = 0;
    /// Edges longer than `longest` of their size stay, and none may get longer than `longestNew` of
    /// it; without sizes any length will do.
    const EdgeSizes* sizes = nullptr;
    double longest = 0, longestNew = 0;
  };

  /// Bit of Point::changed.
  static constexpr std::uint8_t kChanged = 1;

  EdgeCollapser(TetComplex& complex, const Bounds& bounds, const Rules& rules)
      : complex_(complex), bounds_(bounds), rules_(rules), guard_(bounds) {}

  /// Tries every point that changed since it was last tried, those with the shortest edges first.
  /// Returns how many were removed.
  std::size_t sweep();

  std::size_t tried() const { return tried_; } ///< candidates: directed edges

private:
  enum class Answer { No, NotHere, Yes }; ///< NotHere: perhaps in another part

  bool collapsePoint(std::uint32_t from);
  Answer mayCollapse(std::uint32_t to);
  bool makesLong(std::uint32_t to) const;
  bool isShapely(std::uint32_t to) const;
  bool followsCurve(std::uint32_t to, std::uint32_t toSheets) const;
  Answer keepsTopology(std::uint32_t to);

  TetComplex& complex_;
  const Bounds& bounds_;
  const Rules rules_;
  std::size_t tried_ = 0;
  PointStar star_;
  std::vector<PointStar::Spoke> order_;
  SurfaceGuard guard_;
};

} // namespace tetvdb
