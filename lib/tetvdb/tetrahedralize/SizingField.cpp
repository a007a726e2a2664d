// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/SizingField.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/TetEnergy.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace tetvdb {

void updateSpacing(TetComplex& complex, double energy, double smallest, double largest) {
  constexpr double kSlope = 0.5;
  constexpr int kSweeps = 8; // the growth from one tet to the next reaches that far
  std::vector<char> isBad(complex.points.size(), 0);
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t)
    if (complex.tets[t].exists() && energyOf(complex, t) > energy)
      for (const std::uint32_t corner : complex.tets[t].corners)
        isBad[corner] = 1;
  for (std::size_t p = 0; p < complex.points.size(); ++p) {
    const double wanted = complex.points[p].spacing * (isBad[p] ? 0.5 : 1.5);
    complex.points[p].spacing = static_cast<float>(std::min(std::max(wanted, smallest), largest));
  }
  bool falls = true;
  for (int sweep = 0; sweep < kSweeps && falls; ++sweep) {
    falls = false;
    for (const TetComplex::Tet& tet : complex.tets) {
      if (!tet.exists())
        continue;
      for (unsigned i = 0; i < 3; ++i)
        for (unsigned j = i + 1; j < 4; ++j) {
          auto *a = &complex.points[tet.corners[i]], *b = &complex.points[tet.corners[j]];
          if (a->spacing > b->spacing)
            std::swap(a, b);
          if (b->spacing < 1.01f * a->spacing)
            continue;
          const auto most = static_cast<float>(a->spacing + kSlope * length(minus(a->at, b->at)));
          if (b->spacing > 1.001f * most) {
            b->spacing = most;
            falls = true;
          }
        }
    }
  }
}

} // namespace tetvdb
