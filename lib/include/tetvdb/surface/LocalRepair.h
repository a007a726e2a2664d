// SPDX-License-Identifier: Apache-2.0
//
// Makes a cleaned mesh a closed oriented manifold by changes where it is none, and nowhere else.
//
//   tetvdb::cleanTriangles(mesh, {}, progress);
//   tetvdb::LocalRepair repair = tetvdb::repairLocally(mesh, progress);
//   if (!repair.succeeded)
//     print(repair.why); // the mesh is as it was
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

/// What repairLocally() did, and where it gave up, why.
struct LocalRepair {
  bool succeeded = false;
  std::string why;             ///< of a failure: what could not be mended
  std::size_t doubleFaces = 0; ///< dropped, as the surface is there twice
  StitchCounts stitched;
  SheetCounts sheets; ///< dropped, as they bound no volume
  std::vector<FilledHole> holes;
  CrossingCounts crossings;        ///< faces cut along others
  std::size_t separatedPoints = 0; ///< moved apart where solids touch
  double largestMove = 0;          ///< of any point, world units
  SolidComparison solids;          ///< the cleaned mesh and the repaired one
  bool changesVolume = false;      ///< what is lost, or gained, is above 0.1 % of the solid
};

/// The defects that keep a mesh from being written as it is; empty for a closed, oriented manifold
/// of positive volume without self-intersections whose points differ as 32-bit floats.
/// Faces without area count unless they are allowed.
std::string whatIsBroken(const TriangleMesh& mesh, Progress& progress,
                         bool flatFacesAllowed = false);

/// In this order, each only where there is something for it to do: of a surface that is there
/// twice, nearly in the same place (WeldBoundary.h, all points), one goes; points that are equal as
/// 32-bit floats become one; boundaries are stitched (StitchBoundaries.h); sheets are dropped
/// (DropSheets.h); holes are filled (FillHoles.h); faces that cross are cut, and what does not
/// bound the solid goes (RemoveCrossings.h); edges of several faces and points of several fans are
/// parted (SplitFans.h, SeparatePoints.h). The result stands if nothing is broken then (faces
/// without area that could not be flipped may be left) and the solid is the same: what is lost and
/// what is gained (CompareSolids.h) is each below 1 % of it. Otherwise the mesh is left as it was
/// given. Faces that are not concerned stay bit for bit, in order.
LocalRepair repairLocally(TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
