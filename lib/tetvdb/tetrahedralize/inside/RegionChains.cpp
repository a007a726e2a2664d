// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/inside/RegionChains.h"

#include "tetvdb/tetrahedralize/inside/Regions.h"

namespace tetvdb {

bool chainRegions(TetComplex& complex, const std::vector<std::uint16_t>& inside,
                  std::size_t inputCount, Boolean rule, bool keepOutside) {
  std::vector<std::int32_t> regions(complex.tets.size(), kOutsideRegion);
  for (std::size_t t = 0; t < complex.tets.size(); ++t)
    if (complex.tets[t].exists())
      regions[t] = regionOf(inside[t], inputCount, rule);
  const auto beyond = [&](const TetComplex::Tet& tet, unsigned localFace) {
    const std::uint32_t next = tet.neighbours[localFace];
    return next == TetComplex::kOutside ? kOutsideRegion : regions[next];
  };
  for (std::size_t t = 0; t < complex.tets.size(); ++t)
    for (unsigned localFace = 0; complex.tets[t].exists() && localFace < 4; ++localFace)
      if (!complex.tets[t].tracked[localFace] && regions[t] != beyond(complex.tets[t], localFace))
        return false;
  const auto windingOf = [&](std::int32_t region) {
    return region == kOutsideRegion ? 0
                                    : unitChain(static_cast<std::size_t>(region - 1), inputCount);
  };
  for (std::size_t t = 0; t < complex.tets.size(); ++t) {
    TetComplex::Tet& tet = complex.tets[t];
    if (!tet.exists())
      continue;
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      tet.chains[localFace] = windingOf(regions[t]) - windingOf(beyond(tet, localFace));
      tet.tracked[localFace] = tet.chains[localFace] != 0;
    }
    tet.weight = regions[t] == kOutsideRegion && !keepOutside ? kOutsideWeight : 1;
    tet.energy = 0;
  }
  for (TetComplex::Point& point : complex.points)
    point.onBoundary = false;
  return true;
}

} // namespace tetvdb
