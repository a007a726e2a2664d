// SPDX-License-Identifier: Apache-2.0
//
// Cuts faces that cross one another along their crossings and keeps what bounds the solid.
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
  std::size_t metFaces = 0;     ///< that others cross, touch or overlap
  std::size_t cutFaces = 0;     ///< of which a part stays
  std::size_t removedFaces = 0; ///< within the solid, outside of it, or cancelled by an equal one
  std::size_t addedFaces = 0;   ///< in the place of those that were cut
  std::size_t rounds = 0;       ///< of cutting, the last of which found nothing to do
  bool floats = false;          ///< new corners are 32-bit floats
  bool complete = true;         ///< false: given up, and the mesh is as it was
};

/// Where crossings meet.
enum class NewCorners {
  FloatsAsGiven, ///< rounded to 32-bit floats if all points given are floats
  Doubles        ///< as near to where they are as doubles can be
};

/// Of a closed mesh (every edge is run along as often in one direction as in the other) the
/// boundary of the places whose winding number is above 0.5: faces of which one side is such a
/// place and the other is not stay, others go (inner shells, walls, what lies inside out), and
/// faces that others cross, touch or overlap are cut along the crossings; where the corner or an
/// edge of a face lies in another this gets it too. What is cut, and on which side of what it lies,
/// is decided exactly on a lattice of 2^-40 of the mesh's size (TrimChain.h); where crossings meet
/// is then rounded to the lattice, or further (NewCorners). The parts that stay of a face are put
/// together again and triangulated again; faces that nothing meets stay bit for bit, in order, and
/// new ones come last. Rounding may leave new crossings of its own size, so that all is done again
/// until there are none, up to 6 times. Edges may have more than two faces afterwards
/// (SplitFans.h). Gives up where trimChain() does and where parts cannot be put together. About 2
/// us a face, and 50 us a face that is cut.
CrossingCounts removeCrossings(TriangleMesh& mesh, NewCorners corners, Progress& progress);

} // namespace tetvdb
