// SPDX-License-Identifier: Apache-2.0
//
// CGNS (.cgns), on ADF or HDF5, by libcgns.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

#include <vector>

namespace tetvdb {

/// The zones of the first base that has any, laid together: unstructured elements, linear,
/// quadratic, mixed and polyhedral (NGON_n and NFACE_n), and structured zones as hexahedra. Points
/// of zones are not merged. Regions are the families of zones, of zones without family the zones,
/// with their names. Arrays are those of the flow solutions at vertices and cell centres, of the
/// step options.timeStep (the last where that is -1) where the zones say which solution belongs to
/// which step; else of all solutions. Read by a child process, since libcgns ends the program on
/// damaged files; links to other files are refused. Throws Error(Invalid) for whatever is not a
/// whole mesh, Error(Usage) for a step that the file does not have.
CellMesh readCgns(const Source& source, const ReadOptions& options, Report& report,
                  Progress& progress);

/// Whether a zone has solid cells: of the elements only those of mixed sections are read.
bool cgnsHasSolidCells(const Source& source, Report& report, Progress& progress);

/// The times of the base's iterations; empty for a file without.
std::vector<double> cgnsTimes(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
