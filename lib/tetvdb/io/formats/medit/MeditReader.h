// SPDX-License-Identifier: Apache-2.0
//
// Medit (GMF) meshes: .mesh, text, and .meshb, binary, file versions 1 to 4 in either byte order.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// Vertices and cells in file order; a cell's reference is its region, if any solid cell has one
/// that is not 0. Cells of higher order keep their corners, which must come first; triangles and
/// quadrilaterals keep theirs where `options.faces` asks for them. Other keywords
/// and vertex references are ignored. Throws Error(Invalid) with line or byte for an incomplete or
/// inconsistent mesh.
CellMesh readMedit(const Source& source, const ReadOptions& options, Report& report,
                   Progress& progress);
CellMesh readMeditBinary(const Source& source, const ReadOptions& options, Report& report,
                         Progress& progress);

/// Looks for the keywords of cells with a volume; true also for a text without any cells.
bool meditHasSolidCells(const Source& source, Report& report, Progress& progress);
bool meditBinaryHasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
