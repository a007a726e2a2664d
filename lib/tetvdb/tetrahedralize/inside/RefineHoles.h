// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Lattice units.
struct HoleSizes {
  double length;       ///< of edges of tets at holes
  std::size_t maxMore; ///< tets
  /// Points that have to be nearer to where the inside ends: edges of tets whose box is within
  /// `near` of one are no longer than that.
  std::vector<Vec3d> points{};
  double near = 0;
};

/// Refines tets where the inside ends at no faces of the input: in holes, where the winding number
/// passes 0.5 within large tets, which are inside or outside as a whole. Their longest edges are
/// halved until none is longer than asked for; the longest first, so that all end up at about the
/// same size. `inside` is insideOf()'s, before and after. Returns the number of points added: none
/// where all inputs are closed. Serial but for the winding numbers, some us a tet; the same for any
/// number of threads.
std::size_t refineHoles(TetComplex& complex, std::size_t inputCount, const LatticeSoup& soup,
                        const std::vector<std::uint32_t>& missing, const HoleSizes& sizes,
                        std::vector<std::uint16_t>& inside, Progress& progress);

} // namespace tetvdb
