// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/StreamOptions.h"

#include "tetvdb/pipeline/JobFiles.h"
#include "tetvdb/volume/Grids.h"

#include <filesystem>
#include <fmt/format.h>
#include <iterator>
#include <utility>
#include <xxhash.h>

namespace tetvdb {

bool mayStream(const VoxelizeJob& job) {
  return (job.streaming != Streaming::Never || !job.shard.isWhole() || job.plan > 0) && !job.keep &&
         job.preview.empty() && job.meshOutput.empty() &&
         (job.tileSize > 0 || writesNvdb(job) ||
          std::filesystem::path(job.output).extension() == ".vdb") &&
         job.voxelize.fit.voxels == 0 && job.solid.shell == 0 &&
         job.solid.inside != InsideRule::Flood && job.voxelize.path != OccupancyPath::Tets;
}

bool writesNvdb(const VoxelizeJob& job) {
  return job.tileSize == 0 && std::filesystem::path(job.output).extension() == ".nvdb";
}

bool packsArrays(const VoxelizeJob& job) {
  return std::filesystem::path(job.output).extension() == ".vdb" && job.preview.empty() &&
         !job.keep && job.tileSize == 0 && job.levels.isEmpty();
}

bool mustStream(const VoxelizeJob& job) {
  return job.streaming == Streaming::Always || !job.shard.isWhole() || job.plan > 0;
}

std::size_t streamLimit(const VoxelizeJob& job) {
  return job.maxMemory != 0 ? memoryLeft(job.maxMemory) : availableBytes();
}

double bytesWithCopies(const VoxelizeJob& job, double trees) {
  return job.tileSize > 0 ? 2 * trees : trees;
}

VoxelizeOptions streamOptions(const VoxelizeJob& job) {
  VoxelizeOptions options = job.voxelize;
  options.grids = job.grids;
  return options;
}

PartMetadata partMetadata(const VoxelizeJob& job, const GridTransform& transform,
                          const std::string& mark) {
  std::string what =
      mark + fmt::format(" {} {} {} {} {}:{}", int(job.voxelize.rule), int(job.maskType), job.half,
                         job.shard.count, job.levels.first, job.levels.last);
  for (const GridKind kind : job.grids)
    what += fmt::format(" {}", infoOf(kind).name);
  for (std::size_t k = 0; k < 3; ++k)
    what += fmt::format(" {} {}", transform.voxelSize[k], transform.origin[k]);
  const XXH128_hash_t hash = XXH3_128bits(what.data(), what.size());
  return {job.shard.index, job.shard.count, fmt::format("{:016x}{:016x}", hash.high64, hash.low64)};
}

void finishLevels(const VoxelizeJob& job, const openvdb::GridPtrVec& levels) {
  for (const auto& level : levels) {
    if (job.shard.isWhole()) {
      openFirstTile(*level);
      continue;
    }
    level->insertMeta(kPartLevel, openvdb::BoolMetadata(level->saveFloatAsHalf()));
    if (level->saveFloatAsHalf())
      level->setSaveFloatAsHalf(false);
  }
}

void moveReport(Report& told, Report& report) {
  std::move(told.stages.begin(), told.stages.end(), std::back_inserter(report.stages));
  std::move(told.warnings.begin(), told.warnings.end(), std::back_inserter(report.warnings));
  report.partial = report.partial || told.partial;
}

} // namespace tetvdb
