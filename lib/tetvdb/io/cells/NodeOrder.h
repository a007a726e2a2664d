// SPDX-License-Identifier: Apache-2.0
//
// The order of ten-node tets' midpoints in formats that do not define it.
#pragma once

#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// Permutes the midpoints of all ten-node tets of `mesh` to VTK's order, by their positions: each
/// to the edge whose centre is closest. The order must be the same for all cells of a run; it is
/// found in those (of the first thousand) in which every edge has one midpoint. If there is none,
/// the midpoints of the run are removed and the corners kept. Nodes must be in range.
void orderMids(CellMesh& mesh);

} // namespace tetvdb
