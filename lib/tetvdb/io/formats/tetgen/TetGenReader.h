// SPDX-License-Identifier: Apache-2.0
//
// TetGen meshes: NAME.node with NAME.ele, text.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// Reads the file that `source` is, .node or .ele, and its partner beside it. Numbers count from 0
/// or 1, as the first node tells. Attributes of nodes become point arrays `attribute1`, ...; the
/// first attribute of the tetrahedra is their region where it is whole, the others are cell arrays.
/// Boundary markers are left out. Throws Error(Invalid) with line for a partner that is missing and
/// whatever is not a whole, consistent mesh.
CellMesh readTetGen(const Source& source, const ReadOptions& options, Report& report,
                    Progress& progress);

/// The same from both files' bytes.
CellMesh readTetGenPair(const Source& nodeFile, const Source& eleFile, const ReadOptions& options,
                        Report& report, Progress& progress);

} // namespace tetvdb
