// SPDX-License-Identifier: Apache-2.0
//
// Which parts of the faces of a closed chain are the boundary of what it winds around.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/surface/WeldedFaces.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// What becomes of a face or of a part of it.
enum class PartFate : std::uint8_t {
  Stays,        ///< its front is outside
  StaysInverse, ///< its back is outside
  Goes,         ///< both sides are inside, or both outside
  Undecided     ///< too thin to matter: as its neighbours
};

struct FacePart {
  std::vector<Vec3d> outline; ///< convex; turns counter-clockwise around the front; lattice units
  bool inverse = false;       ///< its back is outside
};

/// What is left of a face.
struct FaceRest {
  PartFate fate = PartFate::Stays; ///< of all of it, if there are no parts
  std::vector<FacePart> parts;     ///< that stay; corners within 2^-6 lattice units
};

struct TrimmedChain {
  std::vector<FaceRest> rests; ///< by face; empty if not complete
  std::vector<char> isMet;     ///< by face: that others cross, touch or overlap
  bool complete = true;        ///< false: given up
  bool hasEqualFaces = false;  ///< given up as mergeEqualFaces() has to come first
};

/// The boundary of the places for whose winding number `isInside` holds. Faces with either side of
/// different kinds stay, those with both inside or both outside go; faces that others meet are cut
/// into pieces along the crossings, and pieces stay or go; of pieces that lie on one another in a
/// plane those of the face of lowest number stay. All is decided exactly on the lattice;
/// in pieces thinner than about 2^-8 lattice units nothing can be. Gives up where the faces or
/// their pieces are too many to look at (kMax... in the source: some thousand large
/// faces that all cross), or the chain is longer than 2^40 lattice units. Parallel; the same for
/// any number of threads. About 1 us a face where none is met, and 10 us for every piece of one
/// that is.
TrimmedChain trimChain(const WeldedFaces& welded, bool (*isInside)(std::int64_t),
                       Progress& progress);

} // namespace tetvdb
