// SPDX-License-Identifier: Apache-2.0
//
// The faces that level set, fog and coverage of a solid are found from. Internal.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/geometry/BoundaryWinding.h"
#include "tetvdb/geometry/FillRule.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/SolidFaces.h"

#include <optional>
#include <vector>

namespace tetvdb {

/// The faces of a solid and derived data. Refers to the mesh.
struct ShapeSolid {
  const std::vector<Vec3d>& points;
  SnappedMesh mesh; ///< the same points, snapped
  Boundary faces;
  std::optional<BoundaryWinding> boundary; ///< of an open soup
  double shell = 0;                        ///< half its thickness, voxels
  std::optional<FillRule> rule;            ///< if faces are closed and winding numbers decide
  openvdb::BoolGrid::Ptr filled;           ///< of a shell on one side of the faces: the enclosed
                                           ///< voxels
  double thickness = 0;                    ///< of that shell, voxels
  bool outward = false;
};

/// Of tets, and of triangles. The shell is for the caller. Throws Error(Invalid) or Error(Usage)
/// where `covers`, coverage being wanted, and the triangles cannot be covered.
ShapeSolid shapeSolid(const TetMesh& mesh, const GridTransform& transform, Progress& progress);
ShapeSolid shapeSolid(const TriangleMesh& mesh, const SolidOptions& how, bool covers,
                      const GridTransform& transform, Progress& progress);

/// Of the boundary of tets; `points` are its points in world space, which must outlive it.
ShapeSolid shapeSolid(const std::vector<Vec3d>& points, const SolidFaces& faces);

/// Keeps those parts of the faces that are the solid's boundary, and returns whether these differ
/// from the faces; warns where that is not possible.
bool trimShape(ShapeSolid& solid, TrimCounts& counts, Report& report, Progress& progress);

/// Expected memory of the shape's grids, with a half-width that is a number, and of what they need
/// besides.
double shapeBytes(const ShapeSolid& solid, const ShapeOptions& options);

void warnOfOverlap(const CoverageSum& sum, Report& report);

} // namespace tetvdb
