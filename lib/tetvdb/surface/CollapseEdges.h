// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/surface/SimplifyState.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The vertices of one number, and what is around them.
struct CollapseRegion {
  std::uint32_t number = 0;
  std::vector<std::uint32_t> faces;  ///< with a corner in the region, ascending
  std::vector<std::uint32_t> others; ///< that reach into its box and stay as they are
  std::vector<VertexPair> features;  ///< with an end in the region
};

/// Collapses edges by OpenMesh's half-edge mesh, cheapest first, `max` at most, and returns how
/// many. Vertices move whose neighbours are all of the region (`regionOf`, by vertex): nothing is
/// written that another region looks at. `features` becomes those with both ends in the region.
/// `guarded`: no face crosses another that did not before (CrossingGuard.h). Throws Error(Invalid)
/// where faces form more than one fan around a vertex.
std::size_t collapseEdges(SimplifyState& state, CollapseRegion& region,
                          const std::vector<std::uint32_t>& regionOf, bool guarded, std::size_t max,
                          Progress& progress);

} // namespace tetvdb
