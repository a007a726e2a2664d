// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/surface/SimplifyState.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The vertices of one region and the faces around them.
struct CollapseRegion {
  std::uint32_t number = 0;
  std::vector<std::uint32_t> faces;  ///< faces with a corner in the region, ascending
  std::vector<std::uint32_t> others; ///< others that intersect the region's box; not changed
  std::vector<VertexPair> features;  ///< features with an end point in the region
};

/// Whether a face has all three corners in a region. `regionOf`: by vertex.
inline bool isFaceWithin(std::uint32_t region, const std::uint32_t* corners,
                         const std::vector<std::uint32_t>& regionOf) {
  return regionOf[corners[0]] == region && regionOf[corners[1]] == region &&
         regionOf[corners[2]] == region;
}

/// Collapses up to `max` edges, the cheapest first, with OpenMesh's half-edge mesh, and returns
/// their number. Moves only vertices whose neighbours are all in the region (`regionOf`, by
/// vertex), so that it writes nothing that another region reads. Replaces `features` by those with
/// both end points in the region. New faces that meet one of the boxes `guarded` intersect no
/// others (CrossingGuard.h). Throws Error(Invalid) if the faces around a vertex form more than one
/// fan.
std::size_t collapseEdges(SimplifyState& state, CollapseRegion& region,
                          const std::vector<std::uint32_t>& regionOf, const BoxTree& guarded,
                          std::size_t max, Progress& progress);

} // namespace tetvdb
