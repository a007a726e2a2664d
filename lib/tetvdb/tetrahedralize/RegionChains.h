// SPDX-License-Identifier: Apache-2.0
//
// The surface of what is kept in place of the surfaces of the inputs.
#pragma once

#include "tetvdb/tetrahedralize/TetComplex.h"
#include "tetvdb/tetrahedralize/Tetrahedralize.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// What the energy of tets outside counts, where they are not kept: what would be 10 inside may be
/// 300 there.
constexpr float kOutsideWeight = 1.f / 30;

/// Where inside ends at tracked faces alone (as it does for closed inputs), faces are tracked from
/// now on only between regions (regionOf(), Regions.h): inner walls, sheets and rims are gone, so
/// that improvement need not keep them. Chains become those of the regions, digit r - 1 for region
/// r: what insideOf() says of the complex from then on is to be read by Boolean::Materials. Tets
/// outside get kOutsideWeight unless `keepOutside`. `inside` is insideOf()'s. False, with nothing
/// changed, where inside ends elsewhere. Linear; about 50 ns a tet.
bool chainRegions(TetComplex& complex, const std::vector<std::uint16_t>& inside,
                  std::size_t inputCount, Boolean rule, bool keepOutside);

} // namespace tetvdb
