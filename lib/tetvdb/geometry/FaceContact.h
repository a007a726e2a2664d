// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// Whether two triangles, three point numbers each, intersect in more than their common points or
/// edge (by number): they cross, one touches the other, or they overlap in a plane. Exact
/// (geometry/Orientation.h). Neither may be collinear, and equal points must have one number;
/// returns false for triangles with all three points in common.
bool facesMeet(const std::vector<Vec3d>& points, const std::uint32_t* a, const std::uint32_t* b);

} // namespace tetvdb
