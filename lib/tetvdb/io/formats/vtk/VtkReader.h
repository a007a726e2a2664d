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
/// cell array that has a number type. Field data of the dataset itself is left out. With
/// `options.attributes` false only integer cell arrays are kept. Throws Error(Invalid) with line
/// (ASCII) or byte (BINARY) for another DATASET and for whatever is not a whole, consistent mesh; a
/// data section that ends early counts as such. Reads once from front to end; 64-bit indices are
/// converted in bulk.
CellMesh readVtk(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress);

/// Whether an unstructured grid has solid cells, by its cells' types; a file without a list of
/// types is read whole. Throws Error(Invalid) as readVtk() does.
bool vtkHasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
