// SPDX-License-Identifier: Apache-2.0
//
// Writes tetrahedra to VTK's XML unstructured grid (.vtu), data appended raw.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TetMesh.h"

#include <string>

namespace tetvdb {

/// Writes points as Float64, tets, every attribute, and the regions as an Int32 cell array
/// `region`. Cell arrays are copied from the mesh's solid cells to their tets. Little-endian with
/// UInt64 block headers; reads back the same. Whole or absent. Throws Error(Write) if it cannot
/// write.
void writeVtu(const std::string& path, const TetMesh& mesh, Progress& progress);

} // namespace tetvdb
