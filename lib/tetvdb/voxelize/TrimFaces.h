// SPDX-License-Identifier: Apache-2.0
//
// From the faces that a solid is made of to those parts of them that are its boundary: where solids
// cross, overlap, touch or contain each other, faces run on within the solid.
//
//   tetvdb::TrimmedFaces trimmed = tetvdb::trimFaces(mesh, faces, tetvdb::FillRule::Positive, p);
//   if (trimmed.changed)
//     levelSet(trimmed.mesh, trimmed.faces, ...);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/FillRule.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/TrimCounts.h"

#include <cstddef>
#include <cstdint>

namespace tetvdb {

struct TrimmedFaces {
  SnappedMesh mesh;
  Boundary faces; ///< of weight 1, in no meaningful orientation
  TrimCounts counts;
  bool changed = false; ///< false: all faces are boundary, and mesh and faces are left empty
  bool complete = true; ///< false: given up, and not changed
};

/// The boundary of the places whose winding number `rule` takes for inside. `boundary` must close
/// (for FillRule::Odd every edge must have an even number of faces). Faces with either side of
/// different kinds stay, those with both inside or both outside go; faces that others meet are cut
/// into pieces along the crossings, and pieces stay or go. All is decided exactly on the lattice;
/// corners of pieces are rounded to it at the end, by which no point of them moves farther than
/// 2^-20 voxel, and pieces thinner than about 2^-28 voxel go.
///
/// Gives up where the faces or their pieces are too many to look at (kMax... in the source:
/// some thousand large faces that all cross), or the mesh is longer than 2^20 voxels. The
/// result is the same for any order of faces, of points, and any number of threads. Parallel; about
/// 1 us a face where none is met, and 10 us for every piece of one that is.
TrimmedFaces trimFaces(const SnappedMesh& mesh, const Boundary& boundary, FillRule rule,
                       Progress& progress);

/// How many of the faces others cross, touch or overlap, equal ones counted as one; all of them
/// where there are too many to look at.
std::size_t countMetFaces(const SnappedMesh& mesh, const Boundary& boundary, Progress& progress);

} // namespace tetvdb
