// SPDX-License-Identifier: Apache-2.0
//
// A mesh prepared for rasterizeBoundary(): its points on the lattice, its faces as a chain, and the
// triangles that fill its holes.
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

/// Throws Error(Invalid), with the reason and the size of voxels that would do, for a solid of
/// triangles without voxels, unless options.allowEmpty; warns ("nearly-empty") where an open mesh
/// has few beside those, `surfaceVoxels`, that its faces pass through.
void checkSolid(const TriangleMesh& mesh, const SoupBoundary& boundary, const SolidOptions& solid,
                std::uint64_t activeVoxels, double surfaceVoxels, const VoxelizeOptions& options,
                Report& report);

/// 32 hexadecimal digits: a hash of everything that determines the voxels, which is the faces in
/// their order, the triangles that fill holes, and the rule.
std::string markOf(const SolidFaces& faces);

/// Bytes of `faces`, including those needed while they are rasterised.
double bytesOf(const SolidFaces& faces);

} // namespace tetvdb
