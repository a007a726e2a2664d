// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// Numbers of the points that equal another one once they are rounded to 32-bit floats, as in STL
/// and 3MF: programs that weld would join them.
std::vector<std::uint32_t> equalAsFloats(const std::vector<Vec3d>& points);

/// The nearest point whose coordinates are 32-bit floats.
Vec3d nearestFloats(const Vec3d& p);

} // namespace tetvdb
