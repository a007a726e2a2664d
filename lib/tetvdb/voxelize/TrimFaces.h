// SPDX-License-Identifier: Apache-2.0
//
// Trims the faces of a solid to those that are its boundary: where solids cross, overlap, touch or
// contain each other, some faces lie within the solid.
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

/// The boundary of the points that `rule` counts as inside by their winding number. `boundary` must
/// close (for FillRule::Odd every edge must have an even number of faces). Faces with either side
/// of different kinds stay, those with both inside or both outside go; faces that others meet are
/// cut along the crossings into smaller faces, which stay or go. All is decided exactly on the
/// lattice; at the end corners of the smaller faces are rounded to it, which moves no point farther
/// than 2^-20 voxel and removes those thinner than about 2^-28 voxel.
///
/// Changes nothing and says so if there are too many faces or crossings (kMax... in the source:
/// some thousand large faces that all cross), or if the mesh is longer than 2^20 voxels. The result
/// does not depend on the order of faces and points or on the number of threads. Parallel; costs
/// about 1 us a face that no other meets, and 10 us for each smaller face made.
TrimmedFaces trimFaces(const SnappedMesh& mesh, const Boundary& boundary, FillRule rule,
                       Progress& progress);

/// How many of the faces others cross, touch or overlap, equal ones counted as one; all of them
/// where there are too many to look at.
std::size_t countMetFaces(const SnappedMesh& mesh, const Boundary& boundary, Progress& progress);

} // namespace tetvdb
