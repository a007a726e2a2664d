// SPDX-License-Identifier: Apache-2.0
//
// The order of ten-node tets' mids in formats that leave it to the program that wrote the file.
#pragma once

#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// Puts the mids of all ten-node tets of `mesh` in VTK's order, from where they lie: each to the
/// edge whose middle it is nearest to. The order must be one for all cells of a run, found in those
/// (of the first thousand) in which every edge gets one mid. In a run where there is none, mids are
/// dropped and the corners kept. Nodes must be in range.
void orderMids(CellMesh& mesh);

} // namespace tetvdb
