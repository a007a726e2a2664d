// SPDX-License-Identifier: Apache-2.0
//
// Finds the parts of a closed chain of faces that bound the region it encloses.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/surface/WeldedFaces.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace tetvdb {

/// The decision about a face or a part of it.
enum class PartFate : std::uint8_t {
  Stays,        ///< its front is outside
  StaysInverse, ///< its back is outside
  Goes,         ///< both sides are inside, or both are outside
  Undecided,    ///< too thin to decide: follows its neighbours
  Cut           ///< of a face: parts of it stay
};

struct FacePart {
  std::vector<Vec3d> outline; ///< convex, counter-clockwise around the front; lattice units
  bool inverse = false;       ///< its back is outside
};

struct TrimmedChain {
  std::vector<PartFate> fates; ///< by face; empty if not complete
  /// The parts that stay of faces that are cut; corners within 2^-6 lattice units.
  std::map<std::uint32_t, std::vector<FacePart>> parts;
  std::vector<char> isMet;    ///< by face: others cross, touch or overlap it
  bool complete = true;       ///< false: it failed
  bool hasEqualFaces = false; ///< it failed since mergeEqualFaces() must be called first

  /// Whether all of the face stays.
  bool stays(std::size_t face) const {
    return fates[face] == PartFate::Stays || fates[face] == PartFate::StaysInverse;
  }
  bool isCut(std::size_t face) const { return fates[face] == PartFate::Cut; }
};

/// Returns the boundary of the region of winding numbers for which `isInside` holds. Faces with
/// exactly one side inside stay, other faces are removed. Faces that meet others are cut into
/// pieces along the intersections, and each piece stays or is removed. Of coincident pieces in
/// one plane, those of the face with the lowest number stay. All decisions are exact on the
/// lattice; pieces thinner than about 2^-8 lattice units remain undecided. Fails if there are
/// too many faces or pieces (kMax... in the source: several thousand large faces that all
/// intersect), or if the chain is longer than 2^40 lattice units. Parallel; independent of the
/// number of threads. About 1 us per face that meets no other, and 10 us per piece of the other
/// faces.
TrimmedChain trimChain(const WeldedFaces& welded, bool (*isInside)(std::int64_t),
                       Progress& progress);

} // namespace tetvdb
