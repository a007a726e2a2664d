// SPDX-License-Identifier: Apache-2.0
//
// Legacy VTK files (.vtk), DATASET UNSTRUCTURED_GRID, ASCII and BINARY, file versions 1.0 to 5.1.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// The mesh of an UNSTRUCTURED_GRID or POLYDATA: points, cells in file order, and every point and
/// cell array of a number type. Field data of the dataset itself is ignored. With
/// `options.attributes` false, only integer cell arrays are kept. Throws Error(Invalid) with line
/// (ASCII) or byte (BINARY) for another DATASET and for an incomplete or inconsistent mesh,
/// including truncated data sections. Reads once from front to end; 64-bit indices are converted in
/// bulk.
CellMesh readVtk(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress);

/// Whether an unstructured grid has solid cells, by the types of cells; a file without a list of
/// types is read completely. Throws Error(Invalid) as readVtk() does.
bool vtkHasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
