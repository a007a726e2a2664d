// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/volume/VdbCheck.h"
#include "tetvdb/io/volume/VolumeFormats.h"
#include "tetvdb/volume/Grids.h"

#include <new>
#include <openvdb/io/File.h>

namespace tetvdb {

Volume readVdb(const std::string& path, Progress& progress) {
  initializeOpenVDB();
  progress.check();
  {
    const MappedFile file(path);
    checkVdb(file.bytes(), path);
  }
  progress.check();
  try {
    openvdb::io::File file(path);
    file.open(/*delayLoad=*/false);
    Volume volume;
    const openvdb::MetaMap::Ptr metadata = file.getMetadata();
    for (auto entry = metadata->beginMeta(); entry != metadata->endMeta(); ++entry)
      volume.metadata[entry->first] = entry->second->str();
    const openvdb::GridPtrVecPtr grids = file.getGrids();
    for (const auto& grid : *grids)
      if (grid)
        volume.grids().all.push_back(grid);
    if (volume.grids().all.empty())
      throw Error(Status::Invalid, path, "holds no grid, or was cut short");
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
