// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/SequenceGrids.h"

#include <algorithm>

namespace tetvdb {
namespace {

void addFrame(SequenceGrid& grid, const GridInfo& info, std::size_t frame) {
  if (info.activeVoxels == 0) {
    grid.emptyFrames.push_back(frame);
    return;
  }
  const bool first = grid.all.activeVoxels == 0;
  grid.all.activeVoxels += info.activeVoxels;
  if (first || info.minValue < grid.all.minValue) {
    grid.all.minValue = info.minValue;
    grid.minFrame = frame;
  }
  if (first || info.maxValue > grid.all.maxValue) {
    grid.all.maxValue = info.maxValue;
    grid.maxFrame = frame;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    grid.all.boxMin[k] = first ? info.boxMin[k] : std::min(grid.all.boxMin[k], info.boxMin[k]);
    grid.all.boxMax[k] = first ? info.boxMax[k] : std::max(grid.all.boxMax[k], info.boxMax[k]);
  }
}

} // namespace

std::vector<SequenceGrid> gridsOfSequence(const std::vector<std::vector<GridInfo>>& frames) {
  std::vector<SequenceGrid> grids;
  for (std::size_t frame = 0; frame < frames.size(); ++frame)
    for (const GridInfo& info : frames[frame]) {
      auto known = std::find_if(grids.begin(), grids.end(), [&](const SequenceGrid& grid) {
        return grid.all.name == info.name;
      });
      if (known == grids.end()) {
        known = grids.insert(grids.end(), SequenceGrid{info, frame, frame, {}});
        known->all.activeVoxels = 0;
      }
      addFrame(*known, info, frame);
    }
  return grids;
}

} // namespace tetvdb
