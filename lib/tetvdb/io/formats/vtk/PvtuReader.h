// SPDX-License-Identifier: Apache-2.0
//
// Parallel index files of VTK (.pvtu), which name one .vtu per piece.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// The pieces of `source`, found relative to its path, one after the other; points are not merged,
/// and ghost cells (vtkGhostType, vtkGhostLevels) are kept as duplicates. Throws Error(Invalid) for
/// a missing or broken piece, with its name.
CellMesh readPvtu(const Source& source, const ReadOptions& options, Report& report,
                  Progress& progress);

/// Whether a piece has solid cells: reads only the types of cells, up to the first such piece.
bool pvtuHasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
