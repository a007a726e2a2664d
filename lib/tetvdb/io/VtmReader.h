// SPDX-License-Identifier: Apache-2.0
//
// VTK's multi-block files (.vtm, .vtmb), which name one file per block.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// Combines all blocks that are unstructured grids or polygons (.vtu, .pvtu, .vtp, .vtk, or
/// multi-block files); points are not merged. Regions are the blocks, numbered from 1 in the file's
/// order, with their names. Other blocks are omitted with the warning `block-left-out` and
/// report.partial. Files are searched only in the folder of the file that names them. Throws
/// Error(Invalid) for missing or incomplete files, for cyclic references and for more than 100000
/// blocks.
CellMesh readVtm(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress);

/// Whether a block has solid cells: reads only the types of cells, up to the first such block.
bool vtmHasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
