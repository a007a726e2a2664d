// SPDX-License-Identifier: Apache-2.0
//
// Closes a mesh by adding faces over its boundary edges.
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
  std::size_t edges = 0;  ///< boundary edges, all loops of the hole together
  std::size_t faces = 0;  ///< added faces
  std::size_t points = 0; ///< added points: 0 for plane and small holes
};

struct HoleFilling {
  std::vector<FilledHole> holes; ///< in the order of their faces
};

/// Appends faces until every edge is traversed equally often in both directions (a closed chain).
/// Loops (BoundaryLoops.h) of one plane, one within the other and in opposite directions, bound
/// one annular hole. Plane holes are triangulated in their plane (TriangulatePolygon.h), other
/// holes so that the dihedral angles are small (TriangulateLoop.h). Curved holes of 7 or more
/// edges are then refined and faired to match the surrounding surface (FairPatch.h), unless this
/// would make faces cross. Existing points and faces do not change. About 2 us per boundary edge
/// of small holes.
HoleFilling fillHoles(TriangleMesh& mesh, Progress& progress);

/// The same without refining and fairing: no new points.
HoleFilling fillHolesPlainly(TriangleMesh& mesh, Progress& progress);

/// The same for plane holes only; other holes stay.
HoleFilling fillPlaneHoles(TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
