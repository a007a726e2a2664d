// SPDX-License-Identifier: Apache-2.0
//
// The boundary edges of a triangle soup.
#pragma once

#include "tetvdb/core/Progress.h"

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

/// Sums the directed edges of the faces (three indices each). Parallel, 24 bytes a face. Throws
/// Error(Limit) for an index of 2^31 or more.
SoupBoundary soupBoundary(const std::vector<std::uint32_t>& triangles, Progress& progress);

} // namespace tetvdb
