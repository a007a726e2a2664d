// SPDX-License-Identifier: Apache-2.0
//
// Local improvement: fewer and better tets, the surface kept within the envelope.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/tetrahedralize/complex/SurfaceBounds.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace tetvdb {

struct ImproveOptions {
  double edgeLength = 0;   ///< target, lattice units
  double smallestEdge = 0; ///< no size is less than this, lattice units
  double stopEnergy = 10;  ///< worst AMIPS energy to reach; 3 is the regular tet
  int maxPasses = 80;
  /// Where set, called before passes that follow other rules than those before them: may set
  /// weights of tets.
  std::function<void(TetComplex&)> weigh;
};

struct ImproveCounts {
  int passes = 0;
  double worstEnergy = 0, meanEnergy = 0; ///< over all tets of weight 1
  std::size_t splits = 0, collapses = 0, swaps = 0, moves = 0, peels = 0;
};

/// The worst energy that coarsen() may give to a tet that was better.
constexpr double kCoarsenEnergy = 300;

/// Collapses edges as long as tets become markedly fewer (by a hundredth and more a round), with no
/// regard to length: the quick way to a mesh that is valid and small. A collapse may not leave a
/// tet worse than the worst that was there, nor worse than kCoarsenEnergy where none was.
ImproveCounts coarsen(TetComplex& complex, const Bounds& bounds, Progress& progress);

/// Passes of split, collapse, swap and smooth until the worst energy is at most `stopEnergy`, after
/// section 3.5 of "Fast Tetrahedral Meshing in the Wild". The first passes make the mesh as coarse
/// as the target length and the surface's bounds allow; the others, where no more than 30 is asked
/// for, follow sizes that grow away from its surface (EdgeSizes.h) and make all tets better. They
/// aim a little lower than `stopEnergy`. Around tets that stay bad sizes are made smaller, down to
/// `smallestEdge`, as long as that leaves fewer tets above `stopEnergy` and asks for no more than
/// eight times the coarse mesh's tets; the mesh with the fewest such tets is the result. Parallel
/// by TetParts; the same mesh for any number of threads.
ImproveCounts improve(TetComplex& complex, const Bounds& bounds, const ImproveOptions& options,
                      Progress& progress);

} // namespace tetvdb
