// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

/// How many faces two meshes have in common.
struct MeshChanges {
  std::size_t kept = 0;    ///< over the same three positions, bit for bit, whichever way they look
  std::size_t removed = 0; ///< of the first mesh alone
  std::size_t added = 0;   ///< of the second mesh alone
};

/// Faces are compared by their corners' positions, so that numbering and order do not matter; of
/// equal faces as many are kept as both have. Sorts: about 1 us a face.
MeshChanges meshChanges(const TriangleMesh& before, const TriangleMesh& after);

} // namespace tetvdb
