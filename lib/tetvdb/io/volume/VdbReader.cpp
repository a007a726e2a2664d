// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/volume/VdbCheck.h"
#include "tetvdb/io/volume/VolumeFormats.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <new>
#include <openvdb/io/File.h>
#include <openvdb/io/GridDescriptor.h>
#include <vector>

namespace tetvdb {

namespace {

void addGrids(openvdb::io::File& file, const std::vector<VdbGridEntry>& entries, Volume& volume) {
  openvdb::GridPtrVec& grids = volume.grids().all;
  if (std::all_of(entries.begin(), entries.end(),
                  [](const VdbGridEntry& entry) { return entry.known; })) {
    grids = *file.getGrids();
    grids.erase(std::remove(grids.begin(), grids.end(), nullptr), grids.end());
    return;
  }
  using openvdb::io::GridDescriptor;
  for (const VdbGridEntry& entry : entries)
    if (entry.known)
      grids.push_back(file.readGrid(GridDescriptor::nameAsString(entry.name)));
    else
      volume.unread.push_back({GridDescriptor::stripSuffix(entry.name), entry.type});
}

} // namespace

Volume readVdb(const std::string& path, Progress& progress) {
  initializeOpenVDB();
  progress.check();
  std::vector<VdbGridEntry> entries;
  {
    const MappedFile file(path);
    entries = checkVdb(file.source());
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const auto& a, const auto& b) { return a.name < b.name; });
  progress.check();
  try {
    openvdb::io::File file(path);
    file.open(/*delayLoad=*/false);
    Volume volume;
    const openvdb::MetaMap::Ptr metadata = file.getMetadata();
    for (auto entry = metadata->beginMeta(); entry != metadata->endMeta(); ++entry)
      volume.metadata[entry->first] = entry->second->str();
    addGrids(file, entries, volume);
    if (volume.grids().all.empty() && volume.unread.empty())
      throw Error(Status::Invalid, path, "holds no grid, or was cut short");
    if (volume.grids().all.empty())
      throw Error(Status::Invalid, path,
                  "holds no grid of a type that is read: the type of '" +
                      volume.unread.front().name + "' is " + volume.unread.front().type,
                  "write a grid of numbers, vectors or a mask");
    return volume;
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error(Status::Limit, path, "does not fit in memory, or is damaged");
  } catch (const std::exception& e) {
    throw Error(Status::Invalid, path, std::string("cannot be read: ") + e.what());
  }
}

} // namespace tetvdb
