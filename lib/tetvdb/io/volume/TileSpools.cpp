// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/TileSpools.h"

#include "tetvdb/geometry/NodeIndex.h"
#include "tetvdb/io/volume/TileTree.h"
#include "tetvdb/volume/GridTypes.h"

#include <algorithm>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

// False where they have no node in common.
bool intersect(const NodeBox& a, const NodeBox& b, NodeBox& both) {
  for (std::size_t k = 0; k < 3; ++k) {
    both.low[k] = std::max(a.low[k], b.low[k]);
    both.high[k] = std::min(a.high[k], b.high[k]);
    if (both.low[k] >= both.high[k])
      return false;
  }
  return true;
}

} // namespace

TileSpools::TileSpools(openvdb::GridPtrVec empty, const openvdb::Coord& corner, std::int32_t size,
                       const SpoolOptions& options)
    : empty_(std::move(empty)), cube_{corner.x() & ~(kRootChildSize - 1), corner.y(), corner.z()},
      size_(size), options_(options) {
  options_.store = std::make_shared<TailStore>(options.folder, options.inMemory);
  options_.openFirstTile = true;
  for (std::int32_t y = 0; y < kRootChildSize; y += size)
    for (std::int32_t z = 0; z < kRootChildSize; z += size) {
      files_.push_back({corner.offsetBy(0, y, z), {}});
      files_.back().spools.resize(empty_.size());
    }
}

void TileSpools::add(const openvdb::GridPtrVec& parts, const NodeBox& box) {
  std::vector<std::pair<VdbSpool*, openvdb::GridBase::Ptr>> cuts;
  for (File& file : files_) {
    NodeBox own;
    if (!intersect(nodesOf(file.corner, openvdb::Coord(size_)), box, own))
      continue;
    for (std::size_t g = 0; g < parts.size(); ++g)
      withKnownGrid(*parts[g], [&](auto& part) {
        const auto cut = emptyLike(part);
        if (!takeNodes(part, own, *cut))
          return;
        std::unique_ptr<VdbSpool>& spool = file.spools[g];
        if (!spool) {
          spool = makeVdbSpool(empty_[g], options_);
          spool->beginCube(cube_);
        }
        cuts.emplace_back(spool.get(), cut);
      });
  }
  tbb::parallel_for(std::size_t(0), cuts.size(), [&](std::size_t i) {
    cuts[i].first->add(cuts[i].second);
    cuts[i].second.reset();
  });
}

void TileSpools::finish(const std::function<void(const openvdb::Coord&, Spools&)>& visit) {
  for (File& file : files_) {
    if (std::none_of(file.spools.begin(), file.spools.end(),
                     [](const auto& one) { return one != nullptr; }))
      continue;
    for (std::size_t g = 0; g < empty_.size(); ++g) {
      if (file.spools[g])
        file.spools[g]->endCube();
      else
        file.spools[g] = makeVdbSpool(empty_[g], options_);
    }
    visit(file.corner, file.spools);
    file.spools.clear();
  }
}

} // namespace tetvdb
