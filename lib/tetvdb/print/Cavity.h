// SPDX-License-Identifier: Apache-2.0
//
// Makes a cavity in a solid that leaves a wall of constant thickness.
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
  double wall = 0;  ///< world units: minimum thickness of the remaining wall; two voxels or more
  double close = 0; ///< world units: the cavity is nowhere narrower than twice this; 0: no limit
  double voxel = 0; ///< world units
  const Infill* infill = nullptr; ///< lattice in the cavity; null: none
  ThicknessAt thickness;          ///< of the infill, at voxels of offsetTransform()
  std::size_t maxMemory = 0;      ///< bytes; 0: the available memory
};

struct Cavity {
  TriangleMesh surface; ///< its faces are oriented into the cavity, out of the remaining solid. May
                        ///< be empty
  double wall = 0;      ///< world units: proven minimum distance from the solid's surface
};

/// The cavity is the set of points at distance `wall` or more inside the solid, without points that
/// no ball of radius `close` in it contains (an opening: the union of these balls), and without the
/// infill, which thus begins at the wall. `solid` must be closed, oriented and without
/// self-intersections; distances are to all of its faces, including those around cavities. The
/// surface lies within sqrt(3)/2 voxel of that set's boundary (docs/print.md), and is nowhere
/// closer to the solid's than `wall`, also after its coordinates are rounded to 32-bit floats.
/// Closed, manifold, no two vertices equal as floats. Adds stages "voxelize", "distance", "infill"
/// and "extract" to `report`, all except "infill" twice with `close`. Throws Error(Limit) if memory
/// does not suffice, Error(Usage) for a wall of less than two voxels. Independent of the number of
/// threads. Time and memory are proportional to the cavity's area: about 2 us and 300 bytes per
/// square voxel.
Cavity makeCavity(const TriangleMesh& solid, const CavityOptions& options, Report& report,
                  Progress& progress);

} // namespace tetvdb
