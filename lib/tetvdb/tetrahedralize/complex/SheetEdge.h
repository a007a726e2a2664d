// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <cstdint>

namespace tetvdb {

enum class OnSheet : std::uint8_t { No, Yes, Unknown };

/// Whether edge (a, b) of tet `first` is one of a tracked face. Unknown where none is found and
/// tets around the edge lie in another part.
OnSheet edgeOnSheet(const TetComplex& complex, std::uint32_t a, std::uint32_t b,
                    std::uint32_t first);

} // namespace tetvdb
