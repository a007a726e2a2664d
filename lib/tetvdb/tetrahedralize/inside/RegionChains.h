// SPDX-License-Identifier: Apache-2.0
//
// Replaces the surfaces of the inputs by the surfaces of the regions that are kept.
#pragma once

#include "tetvdb/tetrahedralize/complex/TetComplex.h"
#include "tetvdb/tetrahedralize/inside/Boolean.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Weight of the energy of tets outside, where they are not kept: an energy of 300 there counts as
/// 10 inside.
constexpr float kOutsideWeight = 1.f / 30;

/// Where the inside ends at tracked faces alone (as it does for closed inputs), tracks only faces
/// between regions (regionOf(), Regions.h): inner walls, sheets and boundary edges are not tracked
/// any more, so that improvement need not keep them. Chains become those of the regions, digit r -
/// 1 for region r, so that insideOf() is then to be read by Boolean::Materials. Tets outside get
/// kOutsideWeight unless `keepOutside`. `inside` is insideOf()'s. False, with nothing changed,
/// where the inside ends elsewhere. Linear; about 50 ns a tet.
bool chainRegions(TetComplex& complex, const std::vector<std::uint16_t>& inside,
                  std::size_t inputCount, Boolean rule, bool keepOutside);

/// Where the inside ends elsewhere too, as in the holes of open inputs: tets outside get
/// kOutsideWeight, but for those within a few tets of where it does, and all others weight 1.
/// `inside` is insideOf()'s. Linear; about 50 ns a tet.
void weighOutside(TetComplex& complex, const std::vector<std::uint16_t>& inside,
                  std::size_t inputCount, Boolean rule);

} // namespace tetvdb
