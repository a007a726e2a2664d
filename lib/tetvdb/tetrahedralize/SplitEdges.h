// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/TetComplex.h"

#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// Splits edges of a part that are longer than `longest` in the middle, the longest first; edges on
/// the box's sides and between parts stay. New points are on the rim where the edge is. Serial.
/// Returns how many were split.
std::size_t splitEdges(TetComplex& complex, double longest);

/// Splits edges of tets above `energy`, the worst first, where that makes the worst tet around the
/// edge better: in the middle, or where new points are best that need not lie on the surface. Each
/// tet is tried once unless something around it changes. Serial. Returns how many were split.
std::size_t splitBadTets(TetComplex& complex, double energy);

/// Splits an edge of every tet above `energy`, whatever comes of it, unless the edge is shorter
/// than `shortest`: to get away from where nothing helps. `rank` 0 is the longest edge, 5 the
/// shortest; a tet that comes back can be met in another way. Serial. Returns how many were split.
std::size_t splitStuckTets(TetComplex& complex, double energy, double shortest, std::size_t rank);

/// Bit of Point::changed that splitBadTets() uses.
constexpr std::uint8_t kSplitChanged = 8;

} // namespace tetvdb
