// SPDX-License-Identifier: Apache-2.0
//
// Tetrahedra to Medit's text format (.mesh).
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TetMesh.h"

#include <string>

namespace tetvdb {

/// Writes points, tets and their regions as references; there is no place for attributes. Numbers
/// are the shortest that read back the same. Whole or absent. Throws Error(Write) where it cannot
/// write.
void writeMedit(const std::string& path, const TetMesh& mesh, Progress& progress);

} // namespace tetvdb
