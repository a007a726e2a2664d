// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/EdgeSizes.h"
#include "tetvdb/tetrahedralize/TetComplex.h"

#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// Splits edges of a part that are longer than `share` of their size in the middle, the longest
/// first; edges on the box's sides and between parts stay, and such as no tet of weight 1 has, and
/// such that it would make a tet worse than `energy` and than the worst that was around the edge.
/// New points are on the rim where the edge is. Serial. Returns how many were split.
std::size_t splitEdges(TetComplex& complex, const EdgeSizes& sizes, double share, double energy);

/// Splits edges of tets above `energy`, the worst first, where that makes the worst tet around the
/// edge better: in the middle, or where new points are best that need not lie on the surface. Each
/// tet is tried once unless something around it changes. Serial. Returns how many were split.
std::size_t splitBadTets(TetComplex& complex, double energy);

/// Bit of Point::changed that splitBadTets() uses.
constexpr std::uint8_t kSplitChanged = 8;

} // namespace tetvdb
