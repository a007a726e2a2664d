// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Removes faces with the same points that cancel; with `allButOne`, also all but one of the
/// others. Returns their number.
std::size_t dropEqualFaces(TriangleMesh& mesh, bool allButOne);

/// Replaces points by others (`becomes`, by point), and removes faces that lose an edge by it or
/// cancel one another, and points without faces. A closed mesh stays closed.
void joinPoints(TriangleMesh& mesh, const std::vector<std::uint32_t>& becomes);

struct ContractedEdges {
  std::size_t edges = 0;
  double longest = 0; ///< world units; the distance by which its points were joined
};

/// Contracts the shortest edge of each of these faces (`corners`, three of each) that is shorter
/// than `limit`, in the order of the faces: the point with the higher index becomes the other. A
/// point is moved, or moved to, once: edges at points of contracted ones stay for another call.
ContractedEdges contractShortEdges(TriangleMesh& mesh, const std::vector<std::uint32_t>& corners,
                                   double limit);

} // namespace tetvdb
