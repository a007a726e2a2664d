// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/DeviceGrids.h"

#include "tetvdb/pipeline/JobTrees.h"
#include "tetvdb/volume/NanoGrids.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace tetvdb {

std::vector<NanoBytes>* nanoPlace(const VoxelizeJob& job, std::vector<NanoBytes>& nano) {
  const auto byDevice = [&](GridKind kind) {
    const GridMaker maker = infoOf(kind).maker;
    return maker == GridMaker::Occupancy || maker == GridMaker::Owner ||
           (kind == GridKind::Surface && !isWholeBox(job));
  };
  return std::filesystem::path(job.output).extension() == ".nvdb" && job.fields.empty() &&
                 job.tileSize == 0 && job.levels.isEmpty() &&
                 std::all_of(job.grids.begin(), job.grids.end(), byDevice) && !job.keep &&
                 job.preview.empty() && job.voxelize.fit.voxels == 0
             ? &nano
             : nullptr;
}

bool addLevelSet(std::vector<NanoBytes>& nano, bool keepMask,
                 const std::function<std::optional<NanoBytes>()>& makeLevelSet,
                 Voxelization& made) {
  // It is in memory that the device is about to use again.
  nano.back() = copyOf(nano.back().data.get(), nano.back().size);
  std::optional<NanoBytes> surface = makeLevelSet();
  if (!surface) {
    for (const NanoBytes& grid : nano)
      made.volume.grids().all.push_back(gridOfNano(grid.data.get()));
    nano.clear();
    return false;
  }
  if (!keepMask)
    nano.pop_back();
  nano.push_back(std::move(*surface));
  return true;
}

} // namespace tetvdb
