// SPDX-License-Identifier: Apache-2.0
//
// The faces of a solid as a chain of triangles with distinct points.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/BoxBlocks.h"
#include "tetvdb/geometry/Lattice.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// A triangle whose corners ascend by position. They are counter-clockwise seen from its front.
struct WeldedFace {
  std::array<std::uint32_t, 3> corners;
  std::int32_t weight; ///< not 0; its absolute value is a multiplicity; > 0: the front is outside
};

/// Returns the face with these corners, sorted, and this weight.
WeldedFace ascendingFace(const std::vector<Vec3d>& points, std::array<std::uint32_t, 3> corners,
                         std::int32_t weight);

/// Independent of the order of the given faces and points, except for numbering.
struct WeldedFaces {
  std::vector<Vec3d> points; ///< distinct; lattice units relative to `first`
  std::vector<WeldedFace> faces;
  LatticePoint first{0, 0, 0}; ///< minimum coordinates of all corners
  double extent = 0;           ///< maximum coordinate of `points`
  /// Faces left out: collinear ones, and those that other faces with the same corners cancel.
  std::size_t flat = 0, cancelled = 0;

  std::array<Vec3d, 3> cornersOf(std::size_t face) const {
    const std::array<std::uint32_t, 3>& c = faces[face].corners;
    return {points[c[0]], points[c[1]], points[c[2]]};
  }
};

/// The boxes of all faces. Parallel.
BoxBlocks faceBoxes(const WeldedFaces& welded);

/// Merges faces with the same corners and adds their weights; removes those of weight 0.
void mergeEqualFaces(WeldedFaces& welded);

} // namespace tetvdb
