// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/StreamedVdb.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeStream.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/volume/VdbCheck.h"
#include "tetvdb/volume/ChooseGrids.h"

#include <algorithm>
#include <openvdb/io/GridDescriptor.h>
#include <utility>

namespace tetvdb {
namespace {

VdbHeader streamedHeader(const std::string& path) {
  VdbHeader header = readVdbHeader(path);
  for (VdbGridHeader& grid :
       header.grids) // a file adds a number to names that are empty or not the only ones
    grid.name = openvdb::io::GridDescriptor::stripSuffix(grid.name);
  for (const VdbGridHeader& grid : header.grids)
    if (!grid.parent.empty() || !withGridOfType(grid.type, [](const auto&) {}))
      throw Error(Status::Usage, path, "has grids that cannot be read part by part");
  if (header.grids.empty())
    throw Error(Status::Usage, path, "has no grids");
  return header;
}

} // namespace

VdbHeader checkedVdbHeader(const std::string& path) {
  VdbHeader header = streamedHeader(path);
  const MappedFile file(path);
  std::vector<VdbGridEntry> entries = checkVdb(file.source());
  for (std::size_t g = 0; g < header.grids.size(); ++g)
    header.grids[g].lowers = std::move(entries[g].lowers);
  return header;
}

std::vector<const VdbGridHeader*> chosenGrids(const VdbHeader& header, const std::string& path,
                                              const std::vector<std::string>& names) {
  std::vector<const VdbGridHeader*> grids;
  for (const VdbGridHeader& grid : header.grids)
    grids.push_back(&grid);
  std::stable_sort(
      grids.begin(), grids.end(),
      [](const VdbGridHeader* one, const VdbGridHeader* other) { return one->name < other->name; });
  std::vector<std::string> all;
  for (const VdbGridHeader* grid : grids)
    all.push_back(grid->name);
  std::vector<const VdbGridHeader*> chosen;
  for (const std::size_t g : chooseGrids(all, names, path))
    chosen.push_back(grids[g]);
  return chosen;
}

bool canStreamVolume(const std::string& path) {
  try {
    streamedHeader(path);
    return true;
  } catch (const Error&) {
    return false;
  }
}

} // namespace tetvdb
