// SPDX-License-Identifier: Apache-2.0
//
// Triangles with any defect into tetrahedra within epsilon.
//
//   tetvdb::Tetrahedralization made = tetvdb::tetrahedralize({mesh}, {}, report, progress);
//   writeTetMesh("solid.msh", made.mesh, progress);
//
// Clean and simplify the soup within the envelope; a background mesh over its points; insertion
// triangle by triangle; local improvement; what is inside by winding number. After "Fast
// Tetrahedral Meshing in the Wild" (Hu, Schneider, Wang, Zorin, Panozzo 2020); docs/algorithms.md
// describes the differences. The mesh is valid at every moment: every tet positive by exact
// arithmetic, every face that lies on input within epsilon of it.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/tetrahedralize/TooManyTets.h"
#include "tetvdb/tetrahedralize/inside/Boolean.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

struct TetrahedralizeOptions {
  double epsilon = 0;    ///< world units; 0: 1e-3 of the box's diagonal
  double edgeLength = 0; ///< target, world units; 0: a twentieth of the diagonal
  /// Improve until the worst AMIPS energy (3 for the regular tet) is at most this. 0: stop when
  /// every face is in and collapse no longer pays.
  double stopEnergy = 0;
  int maxPasses = 80; ///< of improvement
  Boolean boolean = Boolean::Materials;
  bool keepOutside = false; ///< keep the tets outside too, up to the background's box, as region -1
  std::size_t maxMemory = 0; ///< bytes for the work without the inputs; 0: no limit
  /// Give up (Error(Limit)) where triangles cut one another into so many tets that inserting them
  /// and finding what is inside takes more than about 10 s of one core and 1 ms a triangle.
  /// Counted, not timed: the same everywhere.
  bool limitsWork = false;
};

/// How far input and output are from one another, both ways.
struct TwoSidedCheck {
  double outToIn = 0;         ///< largest distance found from the tets' surface to the input, world
  double inToOut = 0;         ///< from owed points of the input to the tets' surface, world
  std::size_t owedPoints = 0; ///< input points across which the winding number passes 0.5
  std::size_t lostPoints = 0; ///< of these, farther than epsilon from the tets' surface
  double volume = 0;          ///< of the tets, world units cubed
  double windingVolume = 0;   ///< where the input's winding number is above 0.5, by the same points
};

/// A tet of the result whose energy is above `stopEnergy`.
struct BadTet {
  std::size_t tet = 0; ///< of Tetrahedralization::mesh
  double energy = 0;   ///< AMIPS
  Vec3d centre = {};   ///< world units
};

struct Tetrahedralization {
  /// Positive tets. regions: 1, 2, ... for what the first, second, ... input owns (one region for
  /// Booleans), -1 outside; regionNames is left to the caller.
  TetMesh mesh;
  double epsilonAsked = 0; ///< world units
  /// World units: what was asked, or a half to a sixteenth of it, where more would have been lost.
  double epsilonUsed = 0;
  double edgeLength = 0; ///< world units
  std::size_t simplifiedFaces = 0;
  std::size_t insertedFaces = 0, notInserted = 0;
  int passes = 0;                         ///< of improvement
  double worstEnergy = 0, meanEnergy = 0; ///< AMIPS, of the tets of `mesh`
  std::vector<BadTet> badTets;            ///< the worst first; none without a stop energy
  std::size_t boundaryFaces = 0;          ///< between the tets inside and the outside
  TwoSidedCheck check;
};

/// Inputs are cleaned meshes (cleanTriangles()), one material each. Adds the stage
/// "tetrahedralize", with a part for each step, to `report`, and warnings with `partial` for faces
/// that are not in ("not-inserted"), for tets above the stop energy ("energy"), for what was lost
/// ("lost-surface", "volume"). Where something is lost, and no stop energy is asked for, all is
/// done again within less than epsilon, as long as the deadline of `progress` allows it. Throws
/// Error(Usage) for lengths that make no sense, Error(Invalid) where nothing is inside ("sheets"),
/// Error(Limit) where maxMemory does not suffice, TooManyTets, Error(Cancelled). Parallel; the same
/// tets for any number of threads. Time grows about linearly with faces; docs/benchmarks.md has
/// figures.
Tetrahedralization tetrahedralize(const std::vector<TriangleMesh>& inputs,
                                  const TetrahedralizeOptions& options, Report& report,
                                  Progress& progress);

} // namespace tetvdb
