// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/SheetEdge.h"

namespace tetvdb {

OnSheet edgeOnSheet(const TetComplex& complex, std::uint32_t a, std::uint32_t b,
                    std::uint32_t first) {
  std::uint32_t t = first, last = TetComplex::kNone;
  do {
    const TetComplex::Tet& tet = complex.tets[t];
    const unsigned i = tet.cornerOf(a), j = tet.cornerOf(b);
    std::uint32_t next = TetComplex::kNone;
    for (unsigned k = 0; k < 4; ++k) {
      if (k == i || k == j)
        continue;
      if (tet.tracked[k])
        return OnSheet::Yes;
      if (tet.neighbours[k] != last && next == TetComplex::kNone)
        next = tet.neighbours[k];
    }
    if (next >= TetComplex::kElsewhere)
      return OnSheet::Unknown;
    last = t;
    t = next;
  } while (t != first);
  return OnSheet::No;
}

} // namespace tetvdb
