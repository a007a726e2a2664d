// SPDX-License-Identifier: Apache-2.0
//
// Universal files of I-DEAS (.unv), which Salome, NX, Elmer and many others write.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// Nodes (datasets 781 and 2411), elements (2412) and groups of elements (2430 to 2477), which are
/// the regions with their names; an element of several groups belongs to the last one. Points are
/// as in the file, in its units. Other datasets are ignored, results too. Throws Error(Invalid)
/// with the line for an incomplete or inconsistent mesh.
CellMesh readUnv(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress);

/// Whether the mesh has solid cells: reads the file up to the first one.
bool unvHasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
