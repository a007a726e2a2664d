// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Removes the faces whose entry in `drops` (by face) is not 0; the others keep their order.
/// Returns the number of removed faces.
std::size_t dropFaces(TriangleMesh& mesh, const std::vector<char>& drops);

/// Removes points that no face uses; the others keep their order. Returns their number.
std::size_t dropUnusedPoints(TriangleMesh& mesh);

/// Some faces of a mesh, with only the points that they use.
struct CopiedFaces {
  TriangleMesh mesh;
  std::vector<std::uint32_t> points; ///< of the given mesh, ascending
};
CopiedFaces copyFaces(const TriangleMesh& mesh, const std::vector<std::uint32_t>& faces);

} // namespace tetvdb
