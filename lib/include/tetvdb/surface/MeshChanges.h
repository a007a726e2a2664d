// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

/// The number of faces that two meshes have in common.
struct MeshChanges {
  std::size_t kept = 0;    ///< the same three positions as 32-bit floats, in either orientation
  std::size_t removed = 0; ///< faces of the first mesh only
  std::size_t added = 0;   ///< faces of the second mesh only
};

/// Compares faces by the positions of their corners; numbering and order do not matter. Of equal
/// faces, min(count in `before`, count in `after`) are kept. Sorts; about 1 us per face.
MeshChanges meshChanges(const TriangleMesh& before, const TriangleMesh& after);

} // namespace tetvdb
