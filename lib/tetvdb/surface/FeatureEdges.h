// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Two vertices, the lower number first.
using VertexPair = std::array<std::uint32_t, 2>;

/// Edges where two faces meet at more than `degrees` from flat, or that do not have exactly two
/// faces: the edges that shape a model. Ascending. In a scan, noise can look like them.
std::vector<VertexPair> featureEdges(const TriangleMesh& mesh, double degrees);

} // namespace tetvdb
