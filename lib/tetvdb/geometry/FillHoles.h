// SPDX-License-Identifier: Apache-2.0
//
// Triangles over the holes of an open surface: surface and reversed triangles together are closed.
#pragma once

#include "tetvdb/geometry/BoundaryWinding.h"
#include "tetvdb/geometry/Lattice.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// A triangle that counts `weight` times.
struct FillTriangle {
  LatticePoint a, b, c;
  std::int32_t weight; ///< > 0
};

/// Returns triangles whose directed edges sum to `edges`, the boundary edges of a surface: the
/// winding number of the surface minus that of the triangles is an integer everywhere. Boundary
/// edges are divided into loops, the shortest first that a search over few points finds, and a loop
/// of n edges is cut into n - 2 triangles by halving it; chords longer than kMaxTetExtent are split
/// at intermediate points. The edges must be closed: the weights at every point sum to zero. Points
/// are distinguished by position; the result does not depend on the order of the edges. O(n log n).
std::vector<FillTriangle> fillHoles(const std::vector<BoundaryEdge>& edges);

} // namespace tetvdb
