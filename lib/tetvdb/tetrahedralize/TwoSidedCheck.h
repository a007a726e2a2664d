// SPDX-License-Identifier: Apache-2.0
//
// Whether the tets are what the input says, looked at from both sides.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/tetrahedralize/Tetrahedralize.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// What checkBothSides() found, beside the figures of TwoSidedCheck.
struct LostSurface {
  TwoSidedCheck figures;
  /// Owed input points that are farther than epsilon from the tets' surface, world, with the
  /// triangle (input, number) each lies on.
  struct Point {
    Vec3d at;
    std::uint32_t input, triangle;
  };
  std::vector<Point> lost;
};

/// Samples the inputs and the surface of the tets (faces of one tet, or between two regions).
///   A point of an input is owed where the winding number of what is to be kept (inputs and Boolean
/// rule together) passes 0.5 from one side of its triangle to the other, which is looked at half an
/// epsilon off the triangle: interior walls, sheets and doubled shells are not owed. An owed point
/// farther than epsilon from the tets' surface is lost. The volume is compared with the winding
/// number's at random points (fixed seed). Inputs are cleaned. Parallel, deterministic; about 10 us
/// a sample, at most about 200 000 samples.
LostSurface checkBothSides(const TetMesh& mesh, const std::vector<TriangleMesh>& inputs,
                           Boolean boolean, double epsilon, Progress& progress);

} // namespace tetvdb
