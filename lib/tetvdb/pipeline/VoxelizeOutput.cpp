// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/VoxelizeOutput.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/fields/ShownValues.h"
#include "tetvdb/io/ArrayFile.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <unistd.h>
#include <utility>

namespace tetvdb {

ShapeOptions shapesOf(const VoxelizeJob& job) {
  ShapeOptions shapes = job.shapes;
  shapes.grids = madeBy(job.grids, {GridMaker::Distance, GridMaker::Share});
  return shapes;
}

// What is made of arrays can have any values.
void checkValues(const VoxelizeJob& job, const std::vector<GridInfo>& grids, Report& report) {
  for (std::size_t i = job.grids.size(); i < grids.size(); ++i) {
    const GridInfo& grid = grids[i];
    const double largest = std::max(std::abs(grid.minValue), std::abs(grid.maxValue));
    if (job.half && grid.activeVoxels > 0 && grid.type != "int32" && largest > kLargestHalf)
      throw Error(Status::Invalid, "`half`",
                  fmt::format("'{}' has values up to {:.6g}, beyond {}, the largest of 16 bits",
                              grid.name, largest, kLargestHalf),
                  fmt::format("leave `half` out, or use `remap={}=0:1`", grid.name));
    const std::string why = whyHidden(grid);
    if (!why.empty())
      report.warn(kHiddenValues, fmt::format("'{}' {}; `remap={}=0:1` makes it visible", grid.name,
                                             why, grid.name));
  }
}

void requireTileFolder(const std::string& folder, int size, const LevelRange& levels,
                       const std::vector<std::string>& inputs) {
  namespace fs = std::filesystem;
  std::error_code error;
  for (const std::string& input : inputs)
    if (fs::equivalent(fs::absolute(input, error).parent_path(), folder, error))
      throw Error(Status::Usage, input, "is in the folder that is to be replaced",
                  "choose another folder");
  for (const FormatUse use : {FormatUse::WriteVolume, FormatUse::WriteArrays})
    if (formatForEnding(folder, use) != nullptr)
      throw Error(Status::Usage, folder, "is a file's name; `tiles` names a folder",
                  "choose another name");
  checkTileFiles(folder, size, levels);
}

std::vector<GridInfo> addDescribedLevels(Volume& volume, const LevelRange& levels,
                                         std::size_t maxMemory, Progress& progress) {
  openvdb::GridPtrVec& all = volume.grids().all;
  const auto own = static_cast<std::ptrdiff_t>(all.size());
  addLevels(volume, levels, maxMemory, progress);
  Volume coarser;
  coarser.grids().all.assign(all.begin() + own, all.end());
  for (const auto& grid : coarser.grids().all)
    openFirstTile(*grid);
  return describe(coarser);
}

void addTileFiles(const TileFilesInfo& files, const std::string& folder, VoxelizeResult& result) {
  result.tileFiles = files.files;
  result.outputs.push_back({folder, files.bytes});
}

void writeOutputs(const VoxelizeJob& job, const VoxelizeOutput& output,
                  const std::function<void()>& writeMesh, VoxelizeResult& result, Report& report,
                  Progress& progress) {
  const auto& [volume, nano, packed, preview] = output;
  StageTimer timer(report, "write");
  progress.stage("write");
  if (!job.meshOutput.empty())
    writeMesh();
  if (!preview.isEmpty()) {
    try {
      preview.write(job.preview);
    } catch (...) {
      if (!job.meshOutput.empty())
        ::unlink(job.meshOutput.c_str());
      throw;
    }
    result.preview = preview.info();
  }
  if (!job.output.empty()) {
    try {
      if (job.tileSize > 0) {
        const TileFilesInfo files = writeTileFiles(job.output, job.tileSize, volume, progress,
                                                   {job.levels, memoryLeft(job.maxMemory)});
        const auto own = static_cast<std::ptrdiff_t>(result.grids.size());
        result.grids.insert(result.grids.end(), files.grids.begin() + own, files.grids.end());
        addTileFiles(files, job.output, result);
      } else if (!nano.empty())
        writeNanoGrids(job.output, nano, progress);
      else if (!packed.empty())
        writeVdb(job.output, volume, packed, progress);
      else if (isArrayFile(job.output))
        writeArrays(job.output, volume, job.arrays, progress);
      else
        writeVolume(job.output, volume, progress);
    } catch (...) {
      if (!job.meshOutput.empty())
        ::unlink(job.meshOutput.c_str()); // nothing, or everything
      if (!preview.isEmpty())
        ::unlink(job.preview.c_str());
      throw;
    }
    if (job.tileSize == 0)
      for (const std::string& path : arrayFiles(job.output))
        result.outputs.push_back(written(path));
  }
  if (!job.meshOutput.empty())
    result.outputs.push_back(written(job.meshOutput));
  if (!preview.isEmpty())
    result.outputs.push_back(written(job.preview));
  if (job.keep)
    result.kept = std::move(volume);
}

} // namespace tetvdb
