// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct SeparatedPoints {
  std::size_t points = 0; ///< moved
  double largestMove = 0; ///< world units
  bool complete = true;   ///< false: some are still equal
};

/// Moves points that are equal as 32-bit floats apart, as splitFans() leaves them where solids
/// touch (programs that weld would join them): the first of each group stays. Points from number
/// `firstAdded` on move in any case: those that splitFans() put on edges touch other faces too. A
/// point goes into the solid that its own faces bound, against the mean of these faces' normals, or
/// along the faces where that will not do, by the least step that makes it differ as floats from
/// all other points: 2^-22 of the largest coordinate first, doubled up to 2^-12. New positions are
/// floats, and no face's normal turns by more than a right angle. Points whose faces cross others
/// then (geometry/FaceContact.h) are tried again in other directions and by larger steps.
SeparatedPoints separateEqualPoints(TriangleMesh& mesh, std::size_t firstAdded, Progress& progress);

} // namespace tetvdb
