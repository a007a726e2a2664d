// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/StreamedVdb.h"
#include "tetvdb/io/volume/TileFolder.h"
#include "tetvdb/io/volume/VdbChildren.h"

#include <functional>
#include <optional>

namespace tetvdb {
namespace {

/// A grid of a file, one entry of its root node at a time, whatever its type.
struct Entries {
  openvdb::GridBase::Ptr empty;
  std::function<openvdb::GridBase::Ptr(openvdb::Coord&)> next;
  openvdb::GridBase::Ptr part; ///< the next one, null at the end
  openvdb::Coord origin;       ///< of it
};

Entries entriesOf(const std::string& path, const VdbHeader& header, const VdbGridHeader& grid) {
  Entries entries;
  KnownGrids::foreach ([&](const auto& tag) {
    using GridT = std::decay_t<decltype(tag)>;
    if (GridT::gridType() != grid.type)
      return;
    auto children = std::make_shared<VdbChildren<GridT>>(path, header, grid);
    entries.empty = children->empty();
    entries.next = [children](openvdb::Coord& origin) -> openvdb::GridBase::Ptr {
      return children->next(origin);
    };
  });
  entries.part = entries.next(entries.origin);
  return entries;
}

} // namespace

TileFilesInfo splitVolumeFile(const std::string& path, const std::vector<std::string>& names,
                              const std::string& folder, int size, Progress& progress,
                              const TileLevels& levels) {
  const VdbHeader header = checkedVdbHeader(path);
  std::vector<Entries> grids;
  openvdb::GridPtrVec empty;
  for (const VdbGridHeader* grid : chosenGrids(header, path, names)) {
    grids.push_back(entriesOf(path, header, *grid));
    empty.push_back(grids.back().empty);
  }
  TileFolder tiles(folder, size, header.metadata, empty, levels);
  for (;;) {
    progress.check();
    std::optional<openvdb::Coord> origin;
    for (const Entries& grid : grids)
      if (grid.part && (!origin || grid.origin < *origin))
        origin = grid.origin;
    if (!origin)
      break;
    openvdb::GridPtrVec parts = empty;
    for (std::size_t g = 0; g < grids.size(); ++g)
      if (grids[g].part && grids[g].origin == *origin)
        parts[g] = grids[g].part;
    tiles.add(parts, *origin, progress);
    for (Entries& grid : grids)
      if (grid.part && grid.origin == *origin) {
        grid.part.reset();
        grid.part = grid.next(grid.origin);
      }
  }
  return tiles.commit(progress);
}

} // namespace tetvdb
