// SPDX-License-Identifier: Apache-2.0
//
// Gambit neutral files (.neu), also used by Fluent and FIDAP.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// Nodes, elements and element groups, which are the regions with their names; an element of
/// several groups belongs to the last one. Linear elements are read; quadratic ones, whose node
/// order is that of Gambit's layers, are skipped as other solid cells. Boundary conditions are
/// ignored. Throws Error(Invalid) for an incomplete mesh.
CellMesh readNeu(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress);

/// Whether the mesh has solid cells: reads the file up to the first one.
bool neuHasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
