// SPDX-License-Identifier: Apache-2.0
//
// Writes tetrahedra to Medit's text format (.mesh).
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TetMesh.h"

#include <string>

namespace tetvdb {

/// Writes points, tets and their regions as references; the format stores no attributes. Numbers
/// are the shortest that read back the same. Whole or absent. Throws Error(Write) if it cannot
/// write.
void writeMedit(const std::string& path, const TetMesh& mesh, Progress& progress);

} // namespace tetvdb
