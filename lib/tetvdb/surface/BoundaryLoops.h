// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/EdgeTable.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// A closed loop of boundary edges, no point of it twice, in the direction in which a face that
/// fills the hole runs along them: against the faces that are there.
struct BoundaryLoop {
  std::vector<std::uint32_t> points;
  /// sides[i] is the side of a face that runs from points[i + 1] to points[i].
  std::vector<std::uint32_t> sides;
};

/// All edges that faces run along more often in one direction than in the other, as loops: with one
/// face on each of their edges, they close the mesh. Edges follow one another around the fan of
/// faces that they bound; a loop that comes to a point again is cut in two there, so that holes
/// that touch at a point are several. Loops of two edges are left out: they close one another. The
/// order follows from that of the faces. Linear.
std::vector<BoundaryLoop> findBoundaryLoops(const TriangleMesh& mesh, const EdgeTable& edges);

} // namespace tetvdb
