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

/// Combines the zones of the first base with zones: unstructured elements, linear, quadratic, mixed
/// and polyhedral (NGON_n and NFACE_n), and structured zones as hexahedra. Points of zones are not
/// merged. Regions are the families of zones, or the zones without family, with their names. Arrays
/// are those of the flow solutions at vertices and cell centres, of the step options.timeStep (the
/// last if it is -1) if the zones assign solutions to steps; else of all solutions. Read by a child
/// process, since libcgns terminates the program on damaged files; links to other files are
/// refused. Throws Error(Invalid) for an incomplete mesh, Error(Usage) for a step that does not
/// exist.
CellMesh readCgns(const Source& source, const ReadOptions& options, Report& report,
                  Progress& progress);

/// Whether a zone has solid cells: reads only the elements of mixed sections.
bool cgnsHasSolidCells(const Source& source, Report& report, Progress& progress);

/// The times of the base's iterations; empty for a file without iterations.
std::vector<double> cgnsTimes(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
