// SPDX-License-Identifier: Apache-2.0
//
// Writes triangles to binary .stl.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <string>

namespace tetvdb {

/// Coordinates are floats; those beyond the range are written as the largest float. Throws
/// Error(Limit) for more than 4294967295 faces, Error(Write).
void writeStl(const std::string& path, const TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
