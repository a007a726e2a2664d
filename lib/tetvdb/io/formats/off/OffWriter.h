// SPDX-License-Identifier: Apache-2.0
//
// Triangles into .off.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <string>

namespace tetvdb {

/// Points and faces, numbers as they are. Throws Error(Write).
void writeOff(const std::string& path, const TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
