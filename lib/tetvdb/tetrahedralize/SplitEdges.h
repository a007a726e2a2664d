// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/TetComplex.h"

#include <cstddef>

namespace tetvdb {

/// Splits edges of a part that are longer than `longest` times the spacing at their ends, in the
/// middle, the longest first; edges on the box's sides and between parts stay. New points have the
/// mean of their ends' spacings, and are on the rim where the edge is. Serial. Returns how many
/// were split.
std::size_t splitEdges(TetComplex& complex, double longest);

} // namespace tetvdb
