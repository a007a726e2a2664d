// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/mesh/CellMesh.h"

#include <string>

namespace tetvdb {

/// What readCells() does with every mesh once it is read, and what meshes in memory need too: there
/// have to be solid cells; regions are those of options.regionArray, or the mesh's own, or those of
/// an array with a usual name; arrays that nobody asked for are left out. `where` is for messages.
/// Throws Error(Invalid) without solid cells, Error(Usage) for a region array that is none.
void finishCells(const std::string& where, CellMesh& mesh, const ReadOptions& options);

} // namespace tetvdb
