// SPDX-License-Identifier: Apache-2.0
//
// Triangles over the holes of an open surface: surface and reversed triangles together close.
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

/// Triangles whose directed edges sum up to `edges`, the boundary edges of a surface: the winding
/// number of the surface less that of the triangles is a whole number everywhere. Boundary edges
/// are parted into loops, the shortest first that a search over few points finds, and a loop of n
/// edges is cut into n - 2 triangles by halving it; chords longer than kMaxTetExtent are cut at
/// points in between. The edges must close: every point is as often an end as a start, by weight.
/// Points are told apart by place; the order of the edges has no part in the result. O(n log n).
std::vector<FillTriangle> fillHoles(const std::vector<BoundaryEdge>& edges);

} // namespace tetvdb
