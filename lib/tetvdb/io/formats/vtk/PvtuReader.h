// SPDX-License-Identifier: Apache-2.0
//
// Parallel index files of VTK (.pvtu), which name one .vtu a piece.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// The pieces of `source`, found relative to its path, one after the other; points are not merged,
/// and ghost cells (vtkGhostType, vtkGhostLevels) come as the duplicates that they are. Throws
/// Error(Invalid) for a piece that is missing or broken, naming it.
CellMesh readPvtu(const Source& source, const ReadOptions& options, Report& report,
                  Progress& progress);

/// Whether a piece has solid cells: the types of cells alone are read, up to the first such piece.
bool pvtuHasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
