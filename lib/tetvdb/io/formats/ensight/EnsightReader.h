// SPDX-License-Identifier: Apache-2.0
//
// EnSight Gold (.case): parts of unstructured elements or curvilinear blocks, text or C binary,
// with variables at nodes and elements, in one or several steps.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

#include <string>
#include <vector>

namespace tetvdb {

/// The mesh of the step options.timeStep (the last if it is -1), parts as regions with their
/// names. Variables that a part does not have are NaN there. Ghost elements are ignored.
/// Files are searched only in the case's folder. Throws Error(Invalid) for an incomplete
/// mesh, for EnSight 5 and 6 and Fortran's binary files, Error(Usage) for a step that does
/// not exist.
CellMesh readEnsight(const Source& source, const ReadOptions& options, Report& report,
                     Progress& progress);

/// Whether the geometry of the last step has solid cells: reads it up to the first section of
/// these.
bool ensightHasSolidCells(const Source& source, Report& report, Progress& progress);

/// The files that are read for a step (the last if it is -1), all variables among them.
std::vector<std::string> ensightFiles(const Source& source, int timeStep);

/// The times of the steps, ascending.
std::vector<double> ensightTimes(const Source& source, Report& report, Progress& progress);

namespace ensight {

/// The mesh of a geometry file.
CellMesh readGeometry(const Source& source, const ReadOptions& options, Progress& progress);

} // namespace ensight
} // namespace tetvdb
