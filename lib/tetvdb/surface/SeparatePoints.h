// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct SeparatedPoints {
  std::size_t points = 0; ///< moved points
  double largestMove = 0; ///< world units
  bool complete = true;   ///< false: some points are still equal
};

/// Moves points apart that are equal as 32-bit floats. splitFans() makes such points where solids
/// touch; programs that weld would merge them. The first point of each group stays. Points numbered
/// `firstAdded` or higher always move: those that splitFans() puts on edges touch other faces too.
/// A point moves into the solid that its faces bound, against the mean of their normals, or along
/// the faces if that fails, by the smallest step that makes it differ as floats from all other
/// points: 2^-22 of the largest coordinate first, doubled up to 2^-12. New positions are floats,
/// and no face's normal changes by more than a right angle. Points whose faces then intersect
/// others (geometry/FaceContact.h) are moved again in other directions and by larger steps. If
/// such a point cannot be moved, the first of its group is. After 2^14 tests for intersections the
/// others stay as they are.
SeparatedPoints separateEqualPoints(TriangleMesh& mesh, std::size_t firstAdded, Progress& progress);

} // namespace tetvdb
