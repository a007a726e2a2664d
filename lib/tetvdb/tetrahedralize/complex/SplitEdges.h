// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/complex/EdgeSizes.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// Splits edges of a part that are longer than `share` of their size at their midpoints, the
/// longest first. Not split are edges on the box's sides, edges between parts, edges of no tet of
/// weight 1, and edges whose split would make a tet worse than `energy` and worse than the worst
/// tet around the edge. A midpoint is on a boundary edge where the edge is. Serial. Returns how
/// many were split.
std::size_t splitEdges(TetComplex& complex, const EdgeSizes& sizes, double share, double energy);

/// Splits edges of tets above `energy`, the worst first, where that makes the worst tet around the
/// edge better: at the midpoint, or, off the surface, where the new point is best. Each tet is
/// tried once until something around it changes. Serial. Returns how many were split.
std::size_t splitBadTets(TetComplex& complex, const EdgeSizes& sizes, double energy);

/// Bit of Point::changed that splitBadTets() uses.
constexpr std::uint8_t kSplitChanged = 8;

} // namespace tetvdb
