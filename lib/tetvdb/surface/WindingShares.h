// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/EdgeTable.h"

#include <array>
#include <cstddef>

namespace tetvdb {

/// Shares of points, spread evenly over the mesh's box, with a winding number below -0.5, from -0.5
/// to 0.5, from 0.5 to 1.5, and above. The points are always the same ones; their number is
/// `samples`, or less where the mesh has many open edges (work is limited to about a second).
/// `edges` is the table of the mesh once welded, `corners` the point numbers that it was made from.
std::array<double, 4> windingShares(const TriangleMesh& mesh,
                                    const std::vector<std::uint32_t>& corners,
                                    const EdgeTable& edges, std::size_t samples,
                                    Progress& progress);

} // namespace tetvdb
