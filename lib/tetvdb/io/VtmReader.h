// SPDX-License-Identifier: Apache-2.0
//
// VTK's multi-block files (.vtm, .vtmb), which name a file for each block.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// All blocks that are unstructured grids or polygons (.vtu, .pvtu, .vtp, .vtk, or multi-block
/// files again), laid together; points are not merged. Regions are the blocks, numbered from 1 in
/// the file's order, with their names. Blocks of other kinds are left out with the warning
/// `block-left-out` and report.partial. Files are looked for in the folder of the file that names
/// them and nowhere else. Throws Error(Invalid) for files that are missing or not whole, for files
/// that name each other in a circle and for more than 100000 blocks.
CellMesh readVtm(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress);

/// Whether a block has solid cells: the types of cells alone are read, up to the first such block.
bool vtmHasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
