// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct StitchCounts {
  std::size_t joinedPoints = 0; ///< boundary vertices merged with another one
  double largestMove = 0;       ///< largest displacement of these, world units
  std::size_t splitFaces = 0;   ///< faces split at vertices on their edges
  std::size_t flippedFaces = 0; ///< flat faces whose longest edge was flipped
};

/// Closes gaps of no area without adding faces over them:
/// - Two boundary edges of opposite directions are merged if their end points are closer than a
///   tenth of the shortest boundary edges there and a thousandth of the box's diagonal. The vertex
///   with the lower number keeps its position.
/// - A boundary vertex on another boundary edge (within a fiftieth of the shortest boundary edges
///   there) splits the face of that edge, if one of its own edges runs along it. No point moves.
/// - Collinear faces, and faces lower than 2^-22 of the largest coordinate, close such gaps without
///   area. Their longest edge is flipped, unless an edge would then have four faces or a new face
///   would be flat too.
/// Repeats until nothing changes. Other faces do not change and stay in order; the first part of a
/// split face replaces it, the others are appended. Points that no face uses any more are removed.
/// Linear, except for sorting the boundary edges.
StitchCounts stitchBoundaries(TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
