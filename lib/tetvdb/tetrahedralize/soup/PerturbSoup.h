// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include <cstdint>

namespace tetvdb {

/// What perturbedSoup() moves by one random vector.
enum class Perturb : std::uint8_t {
  Points, ///< every point
  /// Every closed component (faces connected across edges), so that sheets that lie upon one
  /// another come apart and stay flat. Open components stay, so that cracks do not open.
  Components
};

/// The soup with its faces in general position. Where many faces lie almost in one plane, insertion
/// leaves tets that no lattice point cuts; after a small perturbation they cross along clear lines.
/// Every point moves by no more than `distance` (lattice units). Equal seeds give equal soups.
/// Keeps LatticeSoup's conditions. Linear.
LatticeSoup perturbedSoup(const LatticeSoup& soup, double distance, Perturb what,
                          std::uint32_t seed);

} // namespace tetvdb
