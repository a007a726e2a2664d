// SPDX-License-Identifier: Apache-2.0
//
// What the grids of a sequence hold over all frames.
#pragma once

#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <vector>

namespace tetvdb {

/// One grid of a sequence.
struct SequenceGrid {
  /// Of the first frame that has the grid; but activeVoxels is the sum, minValue, maxValue and the
  /// box of active voxels are those of all frames.
  GridInfo all;
  std::size_t minFrame = 0, maxFrame = 0; ///< where minValue and maxValue are, counted from 0
  std::vector<std::size_t> emptyFrames;   ///< in which it has no active voxels, counted from 0
};

/// The grids of all frames by name, in the order in which they first occur. Frames of which nothing
/// is known are empty lists.
std::vector<SequenceGrid> gridsOfSequence(const std::vector<std::vector<GridInfo>>& frames);

} // namespace tetvdb
