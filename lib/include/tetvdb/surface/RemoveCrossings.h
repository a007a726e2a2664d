// SPDX-License-Identifier: Apache-2.0
//
// Cuts intersecting faces along their intersections and keeps the faces that bound the solid.
//
//   tetvdb::CrossingCounts counts =
//       tetvdb::removeCrossings(mesh, tetvdb::NewCorners::FloatsAsGiven, progress);
//   print(counts.cutFaces, counts.removedFaces);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct CrossingCounts {
  std::size_t metFaces = 0;     ///< faces that others cross, touch or overlap
  std::size_t cutFaces = 0;     ///< faces of which a part remains
  std::size_t removedFaces = 0; ///< faces not on the solid's boundary, or cancelled by an equal one
  std::size_t addedFaces = 0;   ///< faces that replace the cut ones
  std::size_t rounds = 0;       ///< rounds of cutting; the last one has nothing to cut
  bool complete = true;         ///< false: it failed, and the mesh did not change
};

/// Precision of the intersection points.
enum class NewCorners {
  FloatsAsGiven, ///< rounded to 32-bit floats if all given points are floats
  Doubles        ///< rounded to doubles
};

/// Replaces a closed mesh (every edge is traversed equally often in both directions) by the
/// boundary of the region with a winding number above 0.5. Faces with this region on exactly one
/// side stay; other faces are removed (inner shells, walls, inverted regions). Faces that others
/// cross, touch or overlap are cut along the intersections. A corner or an edge of another face
/// that lies in a face is inserted into it. Cuts and sides are decided exactly on a lattice of
/// 2^-40 of the mesh's size (TrimChain.h); intersection points are then rounded to the lattice,
/// or further (NewCorners). The remaining parts of each face are merged and triangulated again.
/// Faces that no other face meets stay bit for bit and in order; new faces are appended. Rounding
/// may create new intersections of its own size, therefore the process is repeated up to 6 times,
/// until none is left. Edges may then have more than two faces (SplitFans.h). Fails if
/// trimChain() fails or the parts of a face cannot be merged. About 2 us per face, 50 us per cut
/// face.
CrossingCounts removeCrossings(TriangleMesh& mesh, NewCorners corners, Progress& progress);

} // namespace tetvdb
