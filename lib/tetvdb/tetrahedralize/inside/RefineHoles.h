// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Refines tets where the inside ends at no faces of the input: in holes, where the winding number
/// passes 0.5 within large tets, which are inside or outside as a whole. Their longest edges are
/// halved until none is longer than `length`, in lattice units, or there are `maxMore` more tets;
/// the longest first, so that all end up at about the same size. `inside` is insideOf()'s, before
/// and after. Returns the number of points added: none where all inputs are closed. Serial but for
/// the winding numbers, some us a tet; the same for any number of threads.
std::size_t refineHoles(TetComplex& complex, std::size_t inputCount, const LatticeSoup& soup,
                        const std::vector<std::uint32_t>& missing, double length,
                        std::size_t maxMore, std::vector<std::uint16_t>& inside,
                        Progress& progress);

} // namespace tetvdb
