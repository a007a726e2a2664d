// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/mesh/CellMesh.h"

#include <string>
#include <string_view>

namespace tetvdb {

/// The last step of readCells() for every mesh, also for meshes in memory: requires solid cells;
/// sets regions to those of options.regionArray, or the mesh's own, or those of an array with a
/// usual name; removes arrays that were not requested. `where` is for messages. Throws
/// Error(Invalid) without solid cells, Error(Usage) for an invalid region array.
void finishCells(const std::string& where, CellMesh& mesh, const ReadOptions& options);

/// The place of an array's name among the usual names of arrays with region numbers, the most
/// frequent first; -1 where it is none of them.
int usualRegionName(std::string_view name);

} // namespace tetvdb
