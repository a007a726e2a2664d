// SPDX-License-Identifier: Apache-2.0
//
// The mesh of Nastran and OptiStruct bulk data (.bdf, .nas, .fem).
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// GRID in any coordinate system that the file defines, CTETRA, CHEXA, CPENTA and CPYRAM, linear or
/// quadratic; elements with only some of their midpoints by their corners. Regions are the
/// properties (PID). Shells keep their corners where `options.faces` asks for them. Other entries
/// are ignored. Files that an INCLUDE names are read in its place, within the file's folder
/// (io/source/PathWithin.h). Throws Error(Invalid) with line for an incomplete or inconsistent
/// mesh.
CellMesh readNastran(const Source& source, const ReadOptions& options, Report& report,
                     Progress& progress);

/// Reads the names of entries up to the first element with a volume.
bool nastranHasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
