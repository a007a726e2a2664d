// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/EdgeTable.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// A closed loop of boundary edges without repeated points. Its direction is that of a face that
/// fills the hole: opposite to that of the existing faces.
struct BoundaryLoop {
  std::vector<std::uint32_t> points;
  /// sides[i] is the side of a face from points[i + 1] to points[i].
  std::vector<std::uint32_t> sides;
};

/// Returns all edges that are not traversed equally often in both directions, as loops. One face on
/// each edge of the loops closes the mesh. Consecutive edges bound the same fan of faces. A loop
/// that reaches a point a second time is split there, so that holes that touch at a point are
/// separate. Loops of two edges cancel and are left out. The order follows from the order of the
/// faces. Linear.
std::vector<BoundaryLoop> findBoundaryLoops(const TriangleMesh& mesh, const EdgeTable& edges);

} // namespace tetvdb
