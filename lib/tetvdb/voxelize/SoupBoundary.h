// SPDX-License-Identifier: Apache-2.0
//
// The boundary edges of a triangle soup.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// An edge by its points' indices, along which faces run `weight` times more often from a to b than
/// from b to a.
struct IndexedBoundaryEdge {
  std::uint32_t a, b;
  std::int32_t weight; ///< > 0
};

struct SoupBoundary {
  std::vector<IndexedBoundaryEdge>
      edges;                ///< in order of (smaller, larger index); empty: the soup closes
  std::size_t oddEdges = 0; ///< edges of an odd number of faces
};

/// Sums the directed edges of the faces that have three different points. Parallel, linear, about
/// 70 bytes a face while it runs. Throws Error(Limit) for 2^32 / 3 faces or more.
SoupBoundary soupBoundary(const TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
