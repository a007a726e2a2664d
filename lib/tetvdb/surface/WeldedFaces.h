// SPDX-License-Identifier: Apache-2.0
//
// The faces of a solid as a chain of triangles in space: equal places are one point.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/Lattice.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// A triangle whose corners ascend by position. Its front is where they turn counter-clockwise.
struct WeldedFace {
  std::array<std::uint32_t, 3> corners;
  std::int32_t weight; ///< not 0; > 0 where the front is outside, as often as that
};

/// The face of those corners and that weight, its corners brought into order.
WeldedFace ascendingFace(const std::vector<Vec3d>& points, std::array<std::uint32_t, 3> corners,
                         std::int32_t weight);

/// The same but for numbering for any order of the faces and points that it is made from.
struct WeldedFaces {
  std::vector<Vec3d> points; ///< none twice; lattice units from `first`
  std::vector<WeldedFace> faces;
  LatticePoint first{0, 0, 0}; ///< least coordinates of any corner
  double extent = 0;           ///< largest coordinate of `points`
  /// Faces left out: collinear ones, and those that others over the same places cancel.
  std::size_t flat = 0, cancelled = 0;

  std::array<Vec3d, 3> cornersOf(std::size_t face) const {
    const std::array<std::uint32_t, 3>& c = faces[face].corners;
    return {points[c[0]], points[c[1]], points[c[2]]};
  }
};

/// The box of every face. Parallel.
std::vector<Box> boxesOf(const WeldedFaces& welded);

/// Makes faces over the same places one, with the sum of their weights, or none.
void mergeEqualFaces(WeldedFaces& welded);

} // namespace tetvdb
