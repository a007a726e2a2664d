// SPDX-License-Identifier: Apache-2.0
//
// Triangles into binary .stl.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <string>

namespace tetvdb {

/// As floats; coordinates beyond their range are written as the largest float. Throws Error(Limit)
/// for more than 4294967295 faces, Error(Write).
void writeStl(const std::string& path, const TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
