// SPDX-License-Identifier: Apache-2.0
//
// Meshes of the flow solver SU2 (.su2).
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// Points and elements. The zones of a file with several are its regions, with the numbers that the
/// file gives them. Markers of boundaries are ignored. Points of plane meshes get z = 0. Throws
/// Error(Invalid) with the line for an incomplete or inconsistent mesh.
CellMesh readSu2(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress);

/// Whether the mesh has solid cells: reads the file up to the first one.
bool su2HasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
