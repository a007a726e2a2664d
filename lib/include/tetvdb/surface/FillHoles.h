// SPDX-License-Identifier: Apache-2.0
//
// Closes a mesh by faces over its boundary edges.
//
//   tetvdb::HoleFilling filling = tetvdb::fillHoles(mesh, progress);
//   for (const tetvdb::FilledHole& hole : filling.holes)
//     print(hole.edges, hole.faces);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>
#include <vector>

namespace tetvdb {

struct FilledHole {
  std::size_t edges = 0;  ///< of the boundary, all loops of the hole together
  std::size_t faces = 0;  ///< added
  std::size_t points = 0; ///< added: 0 for plane holes and small ones
};

struct HoleFilling {
  std::vector<FilledHole> holes; ///< in the order of their faces
};

/// Adds faces after those that are there until no edge is run along more often in one direction
/// than in the other. Loops (BoundaryLoops.h) that lie in one plane, one within the other and
/// running in opposite directions, bound one hole in the shape of a ring. Plane holes are
/// triangulated in their plane (TriangulatePolygon.h), others so that they bend least
/// (TriangulateLoop.h). Curved holes of 7 edges or more are then made as fine and as smooth as the
/// surface around them by points of their own (FairPatch.h), unless faces would cross others by it.
/// What was there stays as it is, bit for bit. About 2 us a boundary edge of small holes.
HoleFilling fillHoles(TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
