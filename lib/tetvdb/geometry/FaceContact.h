// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// Whether two triangles, three point numbers each, meet in more than the points or the edge that
/// they have in common by number: they cross, one touches the other, or they overlap in a plane.
/// Exact (geometry/Orientation.h). Neither may be collinear, and equal points must have one number;
/// triangles with all three points in common are not looked at (false).
bool facesMeet(const std::vector<Vec3d>& points, const std::uint32_t* a, const std::uint32_t* b);

} // namespace tetvdb
