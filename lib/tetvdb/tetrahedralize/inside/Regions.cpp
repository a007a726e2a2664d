// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/inside/Regions.h"

namespace tetvdb {

std::int32_t regionOf(std::uint16_t mask, std::size_t inputCount, Boolean rule) {
  switch (rule) {
  case Boolean::Materials:
    for (int input = 0; input < 16; ++input)
      if ((mask >> input & 1) != 0)
        return input + 1;
    return kOutsideRegion;
  case Boolean::Union:
    return mask != 0 ? 1 : kOutsideRegion;
  case Boolean::Difference:
    return mask == 1 ? 1 : kOutsideRegion;
  case Boolean::Intersection:
    return mask == (1u << inputCount) - 1 ? 1 : kOutsideRegion;
  }
  return kOutsideRegion;
}

TetMesh keptTets(const TetComplex& complex, const std::vector<std::uint16_t>& inside,
                 std::size_t inputCount, Boolean rule, bool keepOutside,
                 const WorkingLattice& lattice) {
  TetMesh mesh;
  std::vector<std::uint32_t> numbers(complex.points.size(), 0);
  for (std::size_t t = 0; t < complex.tets.size(); ++t) {
    const TetComplex::Tet& tet = complex.tets[t];
    if (!tet.exists())
      continue;
    const std::int32_t region = regionOf(inside[t], inputCount, rule);
    if (region == kOutsideRegion && !keepOutside)
      continue;
    mesh.regions.push_back(region);
    for (const std::uint32_t corner : tet.corners) {
      mesh.tets.push_back(corner);
      numbers[corner] = 1;
    }
  }
  std::uint32_t next = 0;
  for (std::size_t p = 0; p < numbers.size(); ++p)
    if (numbers[p] != 0) {
      numbers[p] = next++;
      mesh.points.push_back(lattice.toWorld(complex.points[p].at));
    }
  for (std::uint32_t& corner : mesh.tets)
    corner = numbers[corner];
  mesh.cellCount = mesh.tetCount();
  return mesh;
}

} // namespace tetvdb
