// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/DeviceGrids.h"

#include "tetvdb/fields/SampleOnDevice.h"
#include "tetvdb/fields/SampledGrids.h"
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
           maker == GridMaker::Share || (maker == GridMaker::Distance && !isWholeBox(job));
  };
  return std::filesystem::path(job.output).extension() == ".nvdb" && job.tileSize == 0 &&
                 job.levels.isEmpty() &&
                 std::all_of(job.grids.begin(), job.grids.end(), byDevice) && !job.keep &&
                 job.preview.empty() && job.voxelize.fit.voxels == 0
             ? &nano
             : nullptr;
}

bool addDeviceShapes(std::vector<NanoBytes>& nano, bool keepMask,
                     const std::function<std::vector<NanoBytes>()>& makeOnDevice,
                     Voxelization& made) {
  // It is in memory that the device is about to use again.
  nano.back() = copyOf(nano.back());
  const std::vector<NanoBytes> grids = makeOnDevice();
  if (grids.empty()) {
    makeTrees(nano, made);
    return false;
  }
  if (!keepMask)
    nano.pop_back();
  nano.insert(nano.end(), grids.begin(), grids.end());
  return true;
}

void makeTrees(std::vector<NanoBytes>& nano, Voxelization& made) {
  for (const NanoBytes& grid : nano)
    made.volume.grids().all.push_back(gridOfNano(grid.data.get()));
  nano.clear();
}

SnapCounts addFields(std::vector<NanoBytes>& nano, const TetMesh& mesh,
                     const std::vector<Field>& fields, const SampleOptions& options,
                     const DeviceChoice& choice, DeviceUsed& used, Voxelization& made,
                     Report& report, Progress& progress) {
  if (!nano.empty()) // it is in memory that the device is about to use again
    nano.back() = copyOf(nano.back());
  const std::size_t others = nano.size();
  const auto volume = [&]() -> Volume& {
    makeTrees(nano, made);
    return made.volume;
  };
  const SnapCounts counts = sampleNanoGrids(mesh, made.transform, fields, options, choice, used,
                                            nano, volume, report, progress);
  if (std::any_of(nano.begin(), nano.end(), [](const NanoBytes& grid) {
        return describeNano(grid.data.get()).leaves == 0;
      })) {
    makeTrees(nano, made);
    for (std::size_t i = 0; i < fields.size(); ++i)
      describeValues(fields[i], *made.volume.grids().all[others + i]);
  }
  return counts;
}

} // namespace tetvdb
