// SPDX-License-Identifier: Apache-2.0
//
// Arrays over cells as arrays at points, whose values vary within a cell.
#pragma once

#include "tetvdb/mesh/TetMesh.h"

namespace tetvdb {

/// Turns every array of floats over the cells into one at the points: the mean over the cells that
/// a point belongs to, each counted once, tuples that are not finite left out (NaN where there is
/// no other). Arrays of whole numbers, and those whose name the points have too, remain as they
/// are. Of points that no tet uses the value is 0. Linear; independent of threads.
void smoothCells(TetMesh& mesh);

} // namespace tetvdb
