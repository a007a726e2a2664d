// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/TetComplex.h"

namespace tetvdb {

/// Halves the spacing at the points of tets above `energy`, lets it grow by half elsewhere, and
/// keeps it within smallest..largest and from growing faster than by half the distance between
/// points: shorter edges where tets will not become better otherwise.
void updateSpacing(TetComplex& complex, double energy, double smallest, double largest);

} // namespace tetvdb
