// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/tetrahedralize/LatticeSoup.h"
#include "tetvdb/tetrahedralize/TetComplex.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Makes tets small where the surface of what is inside follows no faces of the input: in holes,
/// where the winding number passes one half in the midst of large tets, which are in or out as a
/// whole. Their longest edges are halved until none is longer than `length`, in lattice units, or
/// there are `mostMore` more tets; the longest first, so that all are about as small then.
/// `inside` is insideOf()'s, and is when done. Returns how many points were put in: none where all
/// inputs are closed. Serial but for the winding numbers, some us a tet; the same for any number of
/// threads.
std::size_t refineHoles(TetComplex& complex, std::size_t inputCount, const LatticeSoup& soup,
                        const std::vector<std::uint32_t>& missing, double length,
                        std::size_t mostMore, std::vector<std::uint16_t>& inside,
                        Progress& progress);

} // namespace tetvdb
