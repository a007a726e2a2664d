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

/// How curved holes of 7 or more edges are filled.
enum class HolePatches {
  Smooth, ///< continues the surface around it: fills the hole of a ball with a cap
  Taut,   ///< of about the smallest area: flat where the edges are in a plane
  Plain   ///< as Taut, without new points: with long faces
};

/// Appends faces until every edge is traversed equally often in both directions (a closed chain).
/// Loops (BoundaryLoops.h) of one plane, one within the other and in opposite directions, bound
/// one annular hole. Plane holes are triangulated in their plane (TriangulatePolygon.h), other
/// holes so that the dihedral angles are small (TriangulateLoop.h). Patches of curved holes of 7 or
/// more edges are then refined and faired (FairPatch.h), unless they are to be plain or this would
/// make faces cross. Existing points and faces do not change. About 2 us per boundary edge of small
/// holes.
HoleFilling fillHoles(TriangleMesh& mesh, Progress& progress,
                      HolePatches patches = HolePatches::Smooth);

/// The same for plane holes only; other holes stay.
HoleFilling fillPlaneHoles(TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
