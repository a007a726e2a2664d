// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/volume/GridLevels.h"

#include <algorithm>

namespace tetvdb {

TreeLevels::TreeLevels(TreeSource& source, const LevelRange& levels, std::size_t maxMemory,
                       Progress& progress)
    : source_(source), range_(levels), empty_(source.make(NodeBox{}, progress)) {
  gridBytes_ = maxMemory / std::max<std::size_t>(empty_.size(), 1);
  for (const auto& grid : empty_)
    levels_.push_back(makeGridLevels(grid, range_, gridBytes_));
}

void TreeLevels::begin() {
  source_.begin();
  for (std::size_t g = 0; g < empty_.size(); ++g)
    levels_[g] = makeGridLevels(empty_[g], range_, gridBytes_);
}

openvdb::GridPtrVec TreeLevels::make(const NodeBox& box, Progress& progress) {
  openvdb::GridPtrVec grids = source_.make(box, progress);
  for (std::size_t g = 0; g < grids.size(); ++g)
    levels_[g]->add(*grids[g], progress);
  return grids;
}

std::size_t TreeLevels::gridCount() const {
  return empty_.size() * range_.size();
}

openvdb::GridPtrVec TreeLevels::finish() {
  openvdb::GridPtrVec all;
  for (auto& one : levels_) {
    const openvdb::GridPtrVec own = one->finish();
    all.insert(all.end(), own.begin(), own.end());
    one.reset();
  }
  return all;
}

} // namespace tetvdb
