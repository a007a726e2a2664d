// SPDX-License-Identifier: Apache-2.0
//
// Results of CalculiX (.frd): a mesh and the values at its nodes in one or several steps, as text
// (short and long numbers) or binary (floats and doubles).
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

#include <vector>

namespace tetvdb {

/// Nodes, elements of the types 1 to 12 and the arrays of step options.timeStep (the
/// last if it is -1): arrays with the same step number and value belong to one step.
/// Nodes without a value have NaN. Regions are the material numbers if one is not 0,
/// named if the file names its materials; materials with names only are numbered from 1.
/// Throws Error(Invalid) for an incomplete mesh, Error(Usage) for a step that does not
/// exist.
CellMesh readFrd(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress);

/// Whether the mesh has solid cells: reads the file up to the first one.
bool frdHasSolidCells(const Source& source, Report& report, Progress& progress);

/// The values (times, frequencies, load factors) of the steps, in the file's order.
std::vector<double> frdTimes(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
