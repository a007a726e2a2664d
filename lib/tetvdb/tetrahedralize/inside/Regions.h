// SPDX-License-Identifier: Apache-2.0
//
// Which tets are kept, and the region of each.
#pragma once

#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"
#include "tetvdb/tetrahedralize/inside/Boolean.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

constexpr std::int32_t kOutsideRegion = -1;

/// The region of a point that is inside the inputs of `mask` (bit k: input k) of `inputCount`: 1,
/// 2,
/// ... for the lowest one (Boolean::Materials), 1 for what the other rules keep, kOutsideRegion
/// otherwise.
std::int32_t regionOf(std::uint16_t mask, std::size_t inputCount, Boolean rule);

/// The tets of the complex that are in a region, in world space, exactly as on the lattice; with
/// `keepOutside` all of them. `inside` is insideOf()'s. Points keep their order.
TetMesh keptTets(const TetComplex& complex, const std::vector<std::uint16_t>& inside,
                 std::size_t inputCount, Boolean rule, bool keepOutside,
                 const WorkingLattice& lattice);

} // namespace tetvdb
