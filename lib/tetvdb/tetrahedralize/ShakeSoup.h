// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/LatticeSoup.h"

#include <cstdint>

namespace tetvdb {

/// A soup with its faces in general position: where many of them lie all but in the same plane,
/// insertion leaves tets that no lattice point parts; moved a little against each other they cross
/// along clear lines. Every point moves by no more than `distance` (lattice units), and equal seeds
/// give equal soups.
///   `pieces`: what is connected across edges and closed moves as a whole, so that sheets that lie
/// upon one another come apart and stay flat; open pieces stay, so that cracks do not open.
/// Otherwise every point moves by itself. Keeps LatticeSoup's promises. Linear.
LatticeSoup shakenSoup(const LatticeSoup& soup, double distance, bool pieces, std::uint32_t seed);

} // namespace tetvdb
