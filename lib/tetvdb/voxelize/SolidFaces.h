// SPDX-License-Identifier: Apache-2.0
//
// A mesh made ready for rasterizeBoundary(): its points on the lattice, its faces as a chain, and
// what fills its holes.
#pragma once

#include "tetvdb/core/Report.h"
#include "tetvdb/geometry/TriangleClusters.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/BoundaryRaster.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/SoupBoundary.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <optional>
#include <string>

namespace tetvdb {

struct SolidFaces {
  SnappedMesh snapped;
  Boundary chain;
  SoupBoundary boundary;                 ///< of triangles, where they were asked for it
  std::optional<TriangleClusters> holes; ///< of open triangles whose holes are filled
  FillRule rule = FillRule::Positive;
  SnapCounts counts;

  /// Refers to this.
  FillOptions fill() const { return {rule, holes ? &*holes : nullptr}; }
};

/// Throws Error(Usage) for options that do not go together or do not go with triangles,
/// Error(Limit) for 2^32 triangles or more, Error(Invalid) for none.
void checkSolidOptions(const TriangleMesh& mesh, const SolidOptions& solid,
                       const VoxelizeOptions& options);

/// Of triangles. Adds parts to `timer`. Throws as voxelize() does, among others Error(Invalid) for
/// parity where edges have an odd number of faces.
SolidFaces solidFaces(const TriangleMesh& mesh, const SolidOptions& solid,
                      const GridTransform& transform, StageTimer& timer, Progress& progress);

/// Of tets. Adds parts to `timer`.
SolidFaces solidFaces(const TetMesh& mesh, const GridTransform& transform, StageTimer& timer,
                      Progress& progress);

/// Throws Error(Invalid), with the reason, for a solid of triangles without voxels, unless
/// options.allowEmpty; warns ("nearly-empty") where an open mesh has few beside those,
/// `surfaceVoxels`, that its faces pass through.
void checkSolid(const SoupBoundary& boundary, const SolidOptions& solid, std::uint64_t activeVoxels,
                double surfaceVoxels, const VoxelizeOptions& options, Report& report);

/// 32 hexadecimal digits over faces, in their order, with what fills holes, and the rule: what
/// voxels follow from.
std::string markOf(const SolidFaces& faces);

/// Bytes of `faces`, of those needed while they are rasterised too.
double bytesOf(const SolidFaces& faces);

} // namespace tetvdb
