// SPDX-License-Identifier: Apache-2.0
//
// Ten-node tets into eight tets at their own nodes.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Eight tets over the ten nodes of a cell (corners 0 to 3, then the mids of edges 01, 12, 02, 03,
/// 13, 23), by their place among these: one at each corner, and four around the
/// shortest diagonal of the octahedron of mids (of two, by position). Each face is cut into the
/// same four triangles whatever the cell, so that neighbours agree. Of a cell with straight edges
/// and positive volume all eight are positive.
std::array<std::array<std::uint8_t, 4>, 8> cutTet10(const std::uint32_t* nodes,
                                                    const std::vector<Vec3d>& points);

} // namespace tetvdb
