// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/inside/RegionChains.h"

#include "tetvdb/tetrahedralize/inside/Regions.h"

#include <algorithm>

namespace tetvdb {

namespace {

// Tets around holes that keep their weight: the inside may come to end there.
constexpr int kRings = 3;

std::vector<std::int32_t> regionsOf(const TetComplex& complex,
                                    const std::vector<std::uint16_t>& inside,
                                    std::size_t inputCount, Boolean rule) {
  std::vector<std::int32_t> regions(complex.tets.size(), kOutsideRegion);
  for (std::size_t t = 0; t < complex.tets.size(); ++t)
    if (complex.tets[t].exists())
      regions[t] = regionOf(inside[t], inputCount, rule);
  return regions;
}

std::int32_t regionBeyond(const TetComplex::Tet& tet, unsigned localFace,
                          const std::vector<std::int32_t>& regions) {
  const std::uint32_t next = tet.neighbours[localFace];
  return next == TetComplex::kOutside ? kOutsideRegion : regions[next];
}

} // namespace

bool chainRegions(TetComplex& complex, const std::vector<std::uint16_t>& inside,
                  std::size_t inputCount, Boolean rule, bool keepOutside) {
  const std::vector<std::int32_t> regions = regionsOf(complex, inside, inputCount, rule);
  const auto beyond = [&](const TetComplex::Tet& tet, unsigned localFace) {
    return regionBeyond(tet, localFace, regions);
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

void weighOutside(TetComplex& complex, const std::vector<std::uint16_t>& inside,
                  std::size_t inputCount, Boolean rule) {
  const std::vector<std::int32_t> regions = regionsOf(complex, inside, inputCount, rule);
  std::vector<std::uint8_t> ring(complex.points.size(), 0); // 1: where the inside ends
  for (std::size_t t = 0; t < complex.tets.size(); ++t) {
    const TetComplex::Tet& tet = complex.tets[t];
    for (unsigned localFace = 0; tet.exists() && localFace < 4; ++localFace)
      if (!tet.tracked[localFace] && regions[t] != regionBeyond(tet, localFace, regions))
        for (const unsigned corner : kFaceCorners[localFace])
          ring[tet.corners[corner]] = 1;
  }
  const auto isNear = [&](const TetComplex::Tet& tet, int rings) {
    return std::any_of(tet.corners.begin(), tet.corners.end(), [&](std::uint32_t corner) {
      return ring[corner] != 0 && ring[corner] <= rings;
    });
  };
  for (int rings = 1; rings < kRings; ++rings)
    for (const TetComplex::Tet& tet : complex.tets)
      if (tet.exists() && isNear(tet, rings))
        for (const std::uint32_t corner : tet.corners)
          if (ring[corner] == 0)
            ring[corner] = static_cast<std::uint8_t>(rings + 1);
  for (std::size_t t = 0; t < complex.tets.size(); ++t) {
    TetComplex::Tet& tet = complex.tets[t];
    if (!tet.exists())
      continue;
    const float weight = regions[t] == kOutsideRegion && !isNear(tet, kRings) ? kOutsideWeight : 1;
    if (tet.weight == weight)
      continue;
    tet.weight = weight;
    tet.energy = 0;
    for (const std::uint32_t corner : tet.corners)
      complex.points[corner].changed = 0xFF;
  }
}

} // namespace tetvdb
