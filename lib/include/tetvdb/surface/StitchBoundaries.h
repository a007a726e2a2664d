// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct StitchCounts {
  std::size_t joinedPoints = 0; ///< boundary vertices that became one with another
  double largestMove = 0;       ///< of these, world units
  std::size_t splitFaces = 0;   ///< at vertices that lay on their edge
  std::size_t flippedFaces = 0; ///< flat faces that became the other diagonal's
};

/// Closes gaps that are no holes, without faces over them:
/// - two boundary edges that run against each other, their ends nearer than a tenth of the shortest
///   boundary edges there (and than a thousandth of the box's diagonal), become one: an end takes
///   the place of the other, the one of lower number staying where it is;
/// - a boundary vertex on another boundary edge (within a fiftieth of the shortest boundary edges
///   there) that has an edge running along it, splits that edge's face: nothing moves;
/// - faces that are collinear, or less than 2^-22 of the largest coordinate high, which close such
///   gaps without area, are flipped with the neighbour at their longest edge, unless an edge would
///   then have four faces or a face be as flat.
/// Again until nothing changes. Faces that none of this concerns stay as they are, in order; of a
/// face that is split, the first part takes its place and the others come at the end. Points that
/// no face uses any more are dropped. Linear but for the sorting of boundary edges.
StitchCounts stitchBoundaries(TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
