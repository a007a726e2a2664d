// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

struct SelfIntersections {
  std::size_t pairs = 0;
  bool complete = true; ///< false: there are more than `limit`, and `pairs` equals it
};

/// Counts pairs of faces that meet in more than their common points or edge. Exact
/// (geometry/FaceContact.h). Requires distinct points, no collinear face, and no two faces with the
/// same points. Parallel; independent of the number of threads.
SelfIntersections countIntersections(const std::vector<Vec3d>& points,
                                     const std::vector<std::uint32_t>& corners, std::size_t limit,
                                     Progress& progress);

/// Returns the faces of such pairs among those with `looked` not 0 (all if it is empty), ascending.
/// The requirements are the same.
std::vector<std::uint32_t> facesThatMeetOthers(const std::vector<Vec3d>& points,
                                               const std::vector<std::uint32_t>& corners,
                                               const std::vector<char>& looked, Progress& progress);

} // namespace tetvdb
