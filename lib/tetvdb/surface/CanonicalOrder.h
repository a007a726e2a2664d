// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// A welded mesh in an order that depends on its geometry only: points by (x, y, z), the corners of
/// each face from its first point on, faces by their points. Results computed on it, including sums
/// and ties, do not depend on the order of points and faces in the file.
struct CanonicalOrder {
  TriangleMesh mesh;
  /// By face of `mesh`, the number of the input's face; equal faces keep their order.
  std::vector<std::uint32_t> faceWas;
};

/// Points must be distinct, and faces must not have repeated points. Parallel, O(n log n).
CanonicalOrder canonicalOrder(const TriangleMesh& mesh);

} // namespace tetvdb
