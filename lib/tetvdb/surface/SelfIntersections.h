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
  bool complete = true; ///< false: there are more than the limit, which `pairs` is then
};

/// Pairs of faces that meet in more than the points or the edge they have in common, exact
/// (geometry/FaceContact.h). Equal points have one number, no face is collinear and no two are over
/// the same points. Parallel; the same for any number of threads.
SelfIntersections countIntersections(const std::vector<Vec3d>& points,
                                     const std::vector<std::uint32_t>& corners, std::size_t limit,
                                     Progress& progress);

/// Of the faces `looked` at (all where that is empty) those that are of such a pair, ascending.
/// Otherwise as above.
std::vector<std::uint32_t> facesThatMeetOthers(const std::vector<Vec3d>& points,
                                               const std::vector<std::uint32_t>& corners,
                                               const std::vector<char>& looked, Progress& progress);

} // namespace tetvdb
