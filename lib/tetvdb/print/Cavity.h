// SPDX-License-Identifier: Apache-2.0
//
// The cavity that a wall of equal thickness leaves in a solid.
//
//   tetvdb::CavityOptions options;
//   options.wall = 2;
//   options.voxel = 0.1;
//   tetvdb::Cavity cavity = tetvdb::makeCavity(solid, options, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/print/InfillLevelSet.h"

#include <cstddef>

namespace tetvdb {

struct CavityOptions {
  double wall = 0;  ///< world units: what is left of the solid everywhere; two voxels or more
  double close = 0; ///< world units: no place of the cavity is narrower than twice this; 0: any
  double voxel = 0; ///< world units
  const Infill* infill = nullptr; ///< what stays in the cavity; null: nothing
  ThicknessAt thickness;          ///< of the infill, at voxels of offsetTransform()
  std::size_t maxMemory = 0;      ///< bytes; 0: what the machine has available
};

struct Cavity {
  TriangleMesh surface; ///< its faces look into the cavity: out of what is left. May be empty
  double wall = 0;      ///< world units: no point of it is nearer to the solid's surface; proven
};

/// All that is `wall` or more within a solid, without what no ball of radius `close` in it reaches:
/// the union of these balls (an opening), and without the infill, which so begins at the wall.
/// `solid` is closed, oriented and without self-intersections; distances are to all of its faces,
/// those around cavities that it has too. The surface lies within sqrt(3)/2 voxel of that
/// (docs/print.md), and is nowhere nearer to the solid's than `wall`, also once its coordinates are
/// rounded to 32-bit floats. Closed, manifold, no two vertices equal as floats. Adds stages
/// "voxelize", "distance", "infill" and "extract" to `report`, all but "infill" twice with `close`.
/// Throws Error(Limit) where memory does not do, Error(Usage) for a wall of less than two voxels.
/// The same for any number of threads. Time and memory follow the cavity's area: about 2 us and 300
/// bytes for a square of one voxel by one.
Cavity makeCavity(const TriangleMesh& solid, const CavityOptions& options, Report& report,
                  Progress& progress);

} // namespace tetvdb
