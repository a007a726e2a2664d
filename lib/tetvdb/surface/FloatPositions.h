// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// A position in 32-bit floats, as STL and 3MF files have it.
using FloatPosition = std::array<float, 3>;

FloatPosition asFloats(const Vec3d& p);

/// Numbers of the points that equal another one after rounding to 32-bit floats. Programs that weld
/// the points of STL and 3MF files would merge them.
std::vector<std::uint32_t> equalAsFloats(const std::vector<Vec3d>& points);

/// Whether all coordinates are 32-bit floats.
bool areFloats(const std::vector<Vec3d>& points);

/// The nearest point with 32-bit float coordinates.
Vec3d nearestFloats(const Vec3d& p);

} // namespace tetvdb
