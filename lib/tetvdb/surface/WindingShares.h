// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/EdgeTable.h"

#include <array>
#include <cstddef>

namespace tetvdb {

/// Fractions of uniform points in the mesh's box with a winding number below -0.5, from -0.5 to
/// 0.5, from 0.5 to 1.5, and above 1.5. The points are fixed; their number is `samples`, or less if
/// the mesh has many boundary edges (the work is limited to about a second). `edges` is the table
/// of the welded mesh, `corners` the point numbers that it was made from.
std::array<double, 4> windingShares(const TriangleMesh& mesh,
                                    const std::vector<std::uint32_t>& corners,
                                    const EdgeTable& edges, std::size_t samples,
                                    Progress& progress);

} // namespace tetvdb
