// SPDX-License-Identifier: Apache-2.0
//
// OpenFOAM: the case in whose folder a .foam file lies, or a `system/controlDict`: cells of any
// polyhedra, with volume and point fields of one or several times.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

/// The mesh and the fields of the step options.timeStep (the last if it is -1). Cells are in the
/// case's order, tetrahedra, pyramids, wedges and hexahedra recognized, others polyhedra.
/// Regions: the meshes of a case with several, else the cell zones, with their names. Of a
/// decomposed case the processors' parts, whose points are not merged. A field that a part does not
/// have is NaN there; one that OpenFOAM would compute (macros, #calc) is left out with a warning.
/// Files are searched in the case's folder only. Throws Error(Invalid) for an incomplete mesh,
/// Error(Usage) for a step that does not exist.
CellMesh readOpenFoam(const Source& source, const ReadOptions& options, Report& report,
                      Progress& progress);

/// The files that are read for a step (the last if it is -1), all fields among them.
std::vector<std::string> openFoamFiles(const Source& source, int timeStep);

/// The times, ascending.
std::vector<double> openFoamTimes(const Source& source, Report& report, Progress& progress);

namespace openfoam {

constexpr std::string_view kParts = "\n====\n";

/// A mesh and a field on its cells, from the texts of the files points, faces, owner, neighbour,
/// cellZones and that of the field, parted by kParts.
CellMesh readTexts(std::string_view texts, Report& report, Progress& progress);

} // namespace openfoam
} // namespace tetvdb
