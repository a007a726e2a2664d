// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Two vertices, the lower number first.
using VertexPair = std::array<std::uint32_t, 2>;

/// Returns the edges whose faces deviate from a plane by more than `degrees`, and the edges that do
/// not have exactly two faces. Ascending. Noise of scans can produce such edges.
std::vector<VertexPair> featureEdges(const TriangleMesh& mesh, double degrees);

} // namespace tetvdb
