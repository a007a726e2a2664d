// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>
#include <vector>

namespace tetvdb {

/// Drops the faces whose entry in `drops` (by face) is not 0; the others keep their order. Returns
/// how many went.
std::size_t dropFaces(TriangleMesh& mesh, const std::vector<char>& drops);

/// Drops points that no face uses; the others keep their order. Returns how many went.
std::size_t dropUnusedPoints(TriangleMesh& mesh);

} // namespace tetvdb
