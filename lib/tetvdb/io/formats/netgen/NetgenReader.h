// SPDX-License-Identifier: Apache-2.0
//
// Netgen meshes (.vol), text.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// Points and volume elements with 4 to 20 nodes in file order; the material number is the region,
/// named by `materials`. Surface elements keep no nodes, but for their corners where
/// `options.faces` asks for them. Other sections are ignored. Throws
/// Error(Invalid) with line for an incomplete or inconsistent mesh.
CellMesh readNetgen(const Source& source, const ReadOptions& options, Report& report,
                    Progress& progress);

/// By the number of volume elements. Throws Error(Invalid) where it is none.
bool netgenHasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
