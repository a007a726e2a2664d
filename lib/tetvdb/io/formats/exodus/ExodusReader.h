// SPDX-License-Identifier: Apache-2.0
//
// Exodus II files (.exo, .e, .exo2, .g), classic netCDF or HDF5.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

#include <vector>

namespace tetvdb {

/// Element blocks one after the other; a cell's region is its block's id, with the block's
/// name. Nodal and element variables of the last time step, or of options.timeStep, become
/// attributes; components of a vector are separate arrays, and an element variable that a block
/// lacks is 0 there. Triangles, quadrilaterals and shells keep their corners where `options.faces`
/// asks for them. Throws Error(Invalid) for an incomplete or inconsistent mesh. Not
/// parallel: calls to netCDF are serialised by a lock. HDF5 files are read in a child process,
/// since the HDF5 library crashes on damaged ones. Throws Error(Usage) for a time step that
/// does not exist.
CellMesh readExodus(const Source& source, const ReadOptions& options, Report& report,
                    Progress& progress);

/// By the types of the element blocks. Throws as readExodus() does.
bool exodusHasSolidCells(const Source& source, Report& report, Progress& progress);

/// The times of the file's steps; empty if it has none. Throws as readExodus() does.
std::vector<double> exodusTimes(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
