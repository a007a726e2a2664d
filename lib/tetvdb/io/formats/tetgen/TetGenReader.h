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

/// Reads the given file, .node or .ele, and its partner beside it. Numbers count from 0 or 1, as
/// determined by the first node. Attributes of nodes become point arrays `attribute1`, ...; the
/// first attribute of the tetrahedra is their region if it is an integer, the others are cell
/// arrays. Boundary markers are ignored. Throws Error(Invalid) with line for a missing partner and
/// an incomplete or inconsistent mesh.
CellMesh readTetGen(const Source& source, const ReadOptions& options, Report& report,
                    Progress& progress);

/// The same from both files' bytes.
CellMesh readTetGenPair(const Source& nodeFile, const Source& eleFile, const ReadOptions& options,
                        Report& report, Progress& progress);

} // namespace tetvdb
