// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/VoxelizeOutput.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/fields/ShownValues.h"
#include "tetvdb/io/ArrayFile.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <unistd.h>
#include <utility>

namespace tetvdb {
namespace {

bool isCurrent(const std::vector<NanoBytes>& nano, const Volume& volume) {
  const auto& grids = volume.grids().all;
  return !nano.empty() && std::none_of(grids.begin(), grids.end(), [](const auto& grid) {
    return grid->constBaseTree().leafCount() == 1;
  });
}

} // namespace

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
      if (isCurrent(nano, volume))
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
