// SPDX-License-Identifier: Apache-2.0
//
// The content of a sequence's grids over all frames.
#pragma once

#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <vector>

namespace tetvdb {

/// One grid of a sequence.
struct SequenceGrid {
  /// Of the first frame that has the grid; but activeVoxels is the sum, and minValue, maxValue and
  /// the box of active voxels are those of all frames.
  GridInfo all;
  std::size_t minFrame = 0, maxFrame = 0; ///< frames of minValue and maxValue, counted from 0
  std::vector<std::size_t> emptyFrames;   ///< frames without active voxels, counted from 0
};

/// The grids of all frames by name, in the order of their first occurrence. Unknown frames are
/// empty lists.
std::vector<SequenceGrid> gridsOfSequence(const std::vector<std::vector<GridInfo>>& frames);

} // namespace tetvdb
