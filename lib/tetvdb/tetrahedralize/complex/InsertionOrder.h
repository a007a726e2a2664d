// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/BoxTree.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The points from `first` on in an order in which each lies near the one before, and a Delaunay
/// triangulation changes little with each whatever the points are: rounds, each a random sample
/// eight times as large as the one before ("Incremental constructions con BRIO", Amenta, Choi, Rote
/// 2003), and within rounds along a Hilbert curve through `box`. Deterministic. Parallel.
std::vector<std::uint32_t> insertionOrder(const std::vector<Vec3d>& points, std::size_t first,
                                          const Box& box);

} // namespace tetvdb
