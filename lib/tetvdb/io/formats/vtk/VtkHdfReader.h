// SPDX-License-Identifier: Apache-2.0
//
// VTKHDF (.vtkhdf, .hdf): unstructured grids and polygons in HDF5, versions 1 and 2.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

#include <vector>

namespace tetvdb {

/// Combines all parts of the step options.timeStep (the last if it is -1); points are not
/// merged. Read by a child process, since the HDF5 library crashes on damaged files; links to
/// other files, external storage and plugins are refused. Throws Error(Invalid) for an
/// incomplete mesh, for images, AMR and collections; Error(Usage) for a step that does not
/// exist.
CellMesh readVtkHdf(const Source& source, const ReadOptions& options, Report& report,
                    Progress& progress);

/// Whether an unstructured grid has solid cells in any step: reads only the types of cells.
bool vtkHdfHasSolidCells(const Source& source, Report& report, Progress& progress);

/// The times of the steps; empty for a file without steps.
std::vector<double> vtkHdfTimes(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
