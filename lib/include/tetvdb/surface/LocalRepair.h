// SPDX-License-Identifier: Apache-2.0
//
// Repairs a cleaned mesh to a closed oriented manifold. Changes only the faces at defects.
//
//   tetvdb::cleanTriangles(mesh, {}, progress);
//   tetvdb::LocalRepair repair = tetvdb::repairLocally(mesh, progress);
//   if (!repair.succeeded)
//     print(repair.why); // the mesh did not change
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/CompareSolids.h"
#include "tetvdb/surface/DropSheets.h"
#include "tetvdb/surface/FillHoles.h"
#include "tetvdb/surface/RemoveCrossings.h"
#include "tetvdb/surface/StitchBoundaries.h"

#include <cstddef>
#include <string>
#include <vector>

namespace tetvdb {

/// What repairLocally() did, or why it failed.
struct LocalRepair {
  bool succeeded = false;
  std::string why;             ///< the reason of a failure
  std::size_t doubleFaces = 0; ///< removed faces of a surface that exists twice
  StitchCounts stitched;
  SheetCounts sheets; ///< removed components that bound no volume
  std::vector<FilledHole> holes;
  CrossingCounts crossings;        ///< faces that were cut at intersections
  std::size_t separatedPoints = 0; ///< points moved apart where solids touch
  bool roundsToFloats = false;     ///< all coordinates are rounded to 32-bit floats
  std::size_t alignedPoints = 0;   ///< points of intersecting faces, moved onto a coarser lattice
  double largestMove = 0;          ///< of any point, world units
  SolidComparison solids;          ///< compares the cleaned mesh and the repaired one
  bool changesVolume = false;      ///< more than 0.1 % of the solid is lost or gained
  /// More than 1 % is lost or gained, by filling holes and removing sheets.
  bool closingChangesVolume = false;
};

/// Returns the first defect that must be repaired before the mesh is written; empty for a closed,
/// oriented manifold of positive volume without self-intersections whose points differ as 32-bit
/// floats. Faces without area are a defect unless `flatFacesAllowed`.
std::string whatIsBroken(const TriangleMesh& mesh, Progress& progress,
                         bool flatFacesAllowed = false);

/// Applies these steps, each only if needed: removes one of two surfaces that nearly coincide
/// (WeldBoundary.h with all points); merges points that are equal as 32-bit floats; stitches
/// boundaries (StitchBoundaries.h); closes components (CloseComponents.h); removes sheets
/// (DropSheets.h); fills the other holes (FillHoles.h), with taut patches where smooth ones would
/// change the volume by more than 1 %; cuts intersecting faces and removes faces
/// that do not bound the solid (RemoveCrossings.h); separates edges of more than two faces and
/// points of several fans (SplitFans.h, SeparatePoints.h).
///
/// Succeeds if no defect remains (faces without area that cannot be flipped may remain) and the
/// solid is preserved: the lost and the gained volume (CompareSolids.h) are each below 1 %. Up to
/// 10 % may be lost where sheets are removed, and gained where holes are filled, if half of the
/// volume is left. On failure the mesh does not change.
///
/// Faces that no step concerns stay bit for bit and in order, unless cutting succeeds only with all
/// coordinates rounded to 32-bit floats, or with the points of intersecting faces on a lattice of a
/// millionth of the box's diagonal: nearly coplanar faces that overlap become coplanar. Where
/// nothing but a few intersections is left, edges of these faces below a ten-thousandth of the
/// diagonal are contracted (`stitched.joinedPoints`).
LocalRepair repairLocally(TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
