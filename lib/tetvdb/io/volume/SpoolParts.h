// SPDX-License-Identifier: Apache-2.0
//
// All parts of all grids of a source into spools. Internal.
#pragma once

#include "tetvdb/io/volume/GridSpool.h"
#include "tetvdb/volume/TreeSource.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace tetvdb {

template <class Spool>
void spoolOnce(TreeSource& source, const std::vector<std::unique_ptr<Spool>>& spools,
               const ProgressShare& share, Progress& progress) {
  QuietProgress quiet(progress); // what parts do in detail is not reported
  source.begin();
  const std::size_t count = source.cubes().size();
  for (std::size_t c = 0; c < count; ++c) {
    for (const auto& one : spools)
      one->beginCube(source.cubes()[c]);
    const std::vector<NodeBox> parts = source.parts(c);
    for (std::size_t p = 0; p < parts.size(); ++p) {
      openvdb::GridPtrVec grids = source.make(parts[p], quiet);
      for (std::size_t g = 0; g < grids.size(); ++g) {
        spools[g]->add(grids[g]);
        grids[g].reset();
      }
      share.update((double(c) + double(p + 1) / double(parts.size())) / double(count));
    }
    for (const auto& one : spools)
      one->endCube();
  }
}

/// `make(empty, options)`: a spool. `openFirstTile`: of a grid without leaves, as openFirstTile()
/// does; all is made twice then.
template <class Spool, class Make>
std::vector<std::unique_ptr<Spool>> spoolParts(TreeSource& source, const Make& make,
                                               const SpoolOptions& options, bool openFirstTile,
                                               const ProgressShare& share, Progress& progress) {
  const auto empties = [&] {
    std::vector<std::unique_ptr<Spool>> spools;
    for (const openvdb::GridBase::Ptr& grid : source.make(NodeBox{}, progress))
      spools.push_back(make(grid, options));
    return spools;
  };
  std::vector<std::unique_ptr<Spool>> spools = empties();
  spoolOnce(source, spools, share, progress);
  const auto isTilesAlone = [](const auto& one) { return one->tileAlone().has_value(); };
  if (openFirstTile && std::any_of(spools.begin(), spools.end(), isTilesAlone)) {
    std::vector<std::unique_ptr<Spool>> again = empties();
    for (std::size_t g = 0; g < spools.size(); ++g)
      if (const auto tile = spools[g]->tileAlone())
        again[g]->open(*tile);
    spools = std::move(again);
    spoolOnce(source, spools, share, progress);
  }
  return spools;
}

} // namespace tetvdb
