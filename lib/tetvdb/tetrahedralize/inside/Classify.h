// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace tetvdb {

/// For every tet of the mesh (0 for tets that are gone) which inputs it is inside of: bit
/// k where the winding number of input k is above 0.5. Its surface is the chain of the tracked
/// faces and the `missing` faces of the soup, which could not be inserted.
///   Where the chain is closed the winding number is a whole number, the same in all tets between
/// tracked faces: it is summed from face to face, exactly. Elsewhere it is N + s (see
/// geometry/BoundaryWinding.h) at the tets' centres: signed crossings, exact, and the sum over the
/// chain's boundary edges. Parallel; the same for any number of threads. Linear for closed chains.
///   Throws Error(Limit) where an input needs more than `maxSums`, such points times boundary
/// edges, at 1 to 2 ns each.
std::vector<std::uint16_t> insideOf(const TetComplex& complex, std::size_t inputCount,
                                    const LatticeSoup& soup,
                                    const std::vector<std::uint32_t>& missing, Progress& progress,
                                    double maxSums = std::numeric_limits<double>::infinity());

} // namespace tetvdb
