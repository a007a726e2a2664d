// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TetMesh.h"

#include <string>

namespace tetvdb {

/// Writes `mesh` as .msh (Gmsh 4.1 binary), .mesh (Medit ASCII) or .vtu (appended raw), by the
/// path's extension, with attributes and regions as far as the format stores them. Whole or absent.
/// Throws Error(Usage) for another extension, Error(Write) if the file cannot be written. Doubles
/// read back the same.
void writeTetMesh(const std::string& path, const TetMesh& mesh, Progress& progress);

} // namespace tetvdb
