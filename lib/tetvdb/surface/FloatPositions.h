// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// Numbers of the points that equal another one once they are rounded to 32-bit floats, as in STL
/// and 3MF: programs that weld would join them.
std::vector<std::uint32_t> equalAsFloats(const std::vector<Vec3d>& points);

} // namespace tetvdb
