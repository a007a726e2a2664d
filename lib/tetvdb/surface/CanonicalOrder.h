// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// A welded mesh in an order that follows from its geometry alone: points by (x, y, z), each face
/// from its first point on, faces by their points. Whatever is decided on it, sums and ties
/// included, is the same for every order in which a file may list its points and faces.
struct CanonicalOrder {
  TriangleMesh mesh;
  /// By face of `mesh` the one that it was; equal faces in their old order.
  std::vector<std::uint32_t> faceWas;
};

/// No two points may be equal, and no face may have a repeated point. Parallel, O(n log n).
CanonicalOrder canonicalOrder(const TriangleMesh& mesh);

} // namespace tetvdb
