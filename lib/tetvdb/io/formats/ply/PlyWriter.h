// SPDX-License-Identifier: Apache-2.0
//
// Writes triangles to .ply, binary_little_endian, doubles.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <string>

namespace tetvdb {

/// Points and faces, unchanged. Throws Error(Limit) for more than 4294967295 faces or points,
/// Error(Write).
void writePly(const std::string& path, const TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
