// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/StreamJob.h"

#include "nanovdb_kernels/DeviceVoxelizer.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/BitVdbWriter.h"
#include "tetvdb/io/volume/TileFolder.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/pipeline/OriginMetadata.h"
#include "tetvdb/pipeline/PlannedStages.h"
#include "tetvdb/pipeline/ShardRanges.h"
#include "tetvdb/pipeline/StreamOptions.h"
#include "tetvdb/pipeline/StreamTrees.h"
#include "tetvdb/pipeline/VoxelizeOutput.h"
#include "tetvdb/volume/BitLevels.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/KeepResolution.h"
#include "tetvdb/voxelize/NanoOccupancySource.h"
#include "tetvdb/voxelize/OccupancySource.h"
#include "tetvdb/voxelize/SolidFaces.h"
#include "tetvdb/voxelize/TreeEstimate.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <algorithm>
#include <optional>
#include <tbb/task_arena.h>
#include <utility>

namespace tetvdb {
namespace {

// From so many leaves on streaming is faster: three quarters of the time of trees, and less from
// there on.
constexpr double kFasterFrom = 1 << 17;

// What a stack of 128^3 nodes takes on its way if it is full of mixed leaves.
constexpr std::size_t kStackBytes = std::size_t(20) << 20;

openvdb::GridPtrVec emptyGrids(const VoxelizeJob& job, const GridTransform& transform) {
  openvdb::GridPtrVec grids;
  for (const GridKind kind : job.grids) {
    const GridKindInfo& info = infoOf(kind);
    openvdb::GridBase::Ptr grid;
    if (kind == GridKind::Density)
      grid = openvdb::FloatGrid::create(0.0F);
    else if (job.maskType == MaskType::Mask)
      grid = openvdb::MaskGrid::create();
    else
      grid = openvdb::BoolGrid::create(false);
    grid->setName(std::string(info.name));
    grid->setGridClass(openvdb::GridBase::stringToGridClass(std::string(info.gridClass)));
    grid->setTransform(makeTransform(transform));
    grids.push_back(std::move(grid));
  }
  setHalf(job, grids);
  return grids;
}

// A way to the file by one voxel size.
class Stream {
public:
  // `deviceIsFaster`: a GPU voxelizes into trees in less time than the CPU.
  Stream(const VoxelizeJob& job, const GridTransform& transform, bool deviceIsFaster)
      : job_(job), transform_(transform), limit_(streamLimit(job)),
        fasterWins_(job.streaming == Streaming::Auto && !deviceIsFaster) {}

  // Whether trees of the job's grids would be too large, or streaming is asked for.
  bool isNeeded(const SolidFaces& faces) {
    estimate_ = estimateByBoundary(faces.snapped, faces.chain);
    return mustStream(job_) || (fasterWins_ && estimate_.leaves >= kFasterFrom) ||
           tetvdb::bytesOf(faces) + bytesWithCopies(job_, bytesOf(estimate_)) >
               static_cast<double>(limit_);
  }
  // The same, of a box that bounds everything.
  bool mayBeNeeded(const WorldBox& box) const {
    double leaves = 1, lowers = 1, sides[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const double voxels = (box.max[k] - box.min[k]) / transform_.voxelSize[k];
      sides[k] = voxels / kLeafSize + 2;
      leaves *= sides[k];
      lowers *= voxels / kNodeSize + 2;
    }
    const double surface = 2 * (sides[0] * sides[1] + sides[1] * sides[2] + sides[2] * sides[0]);
    return mustStream(job_) || (fasterWins_ && surface >= kFasterFrom / 2) ||
           bytesWithCopies(job_, bytesOf(TreeEstimate{leaves, lowers})) >
               static_cast<double>(limit_) / 4;
  }
  double surfaceVoxels() const { return estimate_.leaves * kLeafSize * kLeafSize; }

  // `columns`: what makes the occupancy in place of the CPU; null: nothing does.
  void write(const SolidFaces& faces, DeviceColumns* columns,
             std::map<std::string, std::string> metadata, VoxelizeResult& result, StageTimer& timer,
             Progress& progress) {
    timer.part("cubes");
    result.counts = faces.counts;
    result.transform = transform_;
    OccupancySource source(faces.snapped, faces.chain, faces.fill(), job_.voxelize.rule, progress);
    if (job_.plan > 0) {
      result.plan = planShards(source.cubes(), source.weights(), job_.plan);
      return;
    }
    timer.part("stream");
    progress.stage(kStreamStage);
    BitVdbOptions options;
    if (!job_.shard.isWhole()) {
      options.part = true;
      options.openFirstTile = false; // that of the whole volume
      partMetadata(job_, transform_, markOf(faces)).add(metadata);
      const CubeRange own = shardRanges(source.weights(), job_.shard.count)[job_.shard.index];
      source.restrict(own.begin, own.end);
    }
    std::optional<NanoOccupancySource> fromDevice;
    if (columns != nullptr)
      fromDevice.emplace(source.cubes(), [&](std::int32_t x, std::int32_t y) {
        return columns->make(x, y, progress);
      });
    BitSource& bits = fromDevice ? static_cast<BitSource&>(*fromDevice) : source;
    const std::size_t threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    options.spoolBytes = std::clamp(limit_ / 16, std::size_t(1) << 20, std::size_t(64) << 20);
    options.window = std::clamp(limit_ / 2 / kStackBytes, std::size_t(2), 4 * threads);
    const openvdb::GridPtrVec grids = emptyGrids(job_, transform_);
    if (job_.tileSize > 0) {
      tiles_.emplace(job_.output, job_.tileSize, std::move(metadata), grids,
                     TileLevels{job_.levels, limit_ / 2});
      tiles_->add(bits, options, progress);
      result.grids = tiles_->grids();
      return;
    }
    std::optional<BitLevels> levels;
    if (!job_.levels.isEmpty()) {
      levels.emplace(bits, job_.levels, limit_ / 2 / grids.size());
      options.moreGrids = grids.size() * job_.levels.size();
    }
    writer_.emplace(job_.output, std::move(metadata), grids, options);
    BitSource& passed = levels ? static_cast<BitSource&>(*levels) : bits;
    result.grids = writer_->write(passed, progress, [&] {
      openvdb::GridPtrVec coarser = levels->finish(grids);
      finishLevels(job_, coarser);
      return coarser;
    });
  }
  void commit(VoxelizeResult& result, Progress& progress) {
    if (job_.plan > 0)
      return;
    progress.check();
    if (tiles_) {
      addTileFiles(tiles_->commit(progress), job_.output, result);
      return;
    }
    writer_->commit(progress);
    result.outputs.push_back(written(job_.output));
  }

private:
  double bytesOf(const TreeEstimate& trees) const {
    return trees.bytes(job_.grids) + trees.levelBytes(job_.levels, job_.grids.size());
  }

  const VoxelizeJob& job_;
  GridTransform transform_;
  std::size_t limit_;
  bool fasterWins_; // streaming, where it is faster than trees
  TreeEstimate estimate_;
  std::optional<BitVdbWriter> writer_;
  std::optional<TileFolder> tiles_;
};

} // namespace

void requireStreamable(const VoxelizeJob& job) {
  if (!job.shard.isWhole() && writesNvdb(job))
    throw Error(Status::Usage, "`shard`", "is for .vdb files: those of shards can be merged",
                "convert the merged volume to .nvdb");
  if ((!job.shard.isWhole() || job.plan > 0) && !canStream(job) && !canStreamTrees(job))
    throw Error(Status::Usage, "`shard`",
                "is for .vdb files of solids, without a preview, a mesh output or `fit`; on a GPU "
                "of density and mask alone, by one GPU each",
                "leave the rest out");
}

bool canStream(const VoxelizeJob& job) {
  const bool occupancy = std::all_of(job.grids.begin(), job.grids.end(), [](GridKind kind) {
    return kind == GridKind::Density || kind == GridKind::Mask;
  });
  const bool byDevice = job.device.numbers.size() == 1 && job.voxelize.rule == VoxelRule::Centre;
  return mayStream(job) && !writesNvdb(job) && occupancy && !job.grids.empty() &&
         job.fields.empty() && (job.device.kind != DeviceKind::Cuda || byDevice);
}

bool streamTets(const VoxelizeJob& job, TetMesh& mesh, VoxelizeResult& result, Report& report,
                Progress& progress) {
  if (canStreamTrees(job))
    return streamTrees(job, mesh, result, report, progress);
  if (!canStream(job) || mesh.tets.empty())
    return false;
  const VoxelizeOptions options = streamOptions(job);
  const WorldBox box = boxOfUsed(mesh.points, mesh.tets);
  const GridTransform transform = chooseTransform(box, options);
  std::string why;
  const bool deviceIsFaster = job.device.kind == DeviceKind::Auto &&
                              estimateCost(box, mesh.tetCount(), transform, options).gains() &&
                              !nano::listDevices(why).empty();
  Stream stream(job, transform, deviceIsFaster);
  const bool whole = job.shard.isWhole();
  if (!stream.mayBeNeeded(box))
    return false;
  checkMesh(mesh);
  progress.stage("voxelize");
  initializeOpenVDB();
  Report told;
  const std::size_t tets = mesh.tetCount();
  {
    StageTimer timer(told, "voxelize");
    SolidFaces faces = solidFaces(mesh, transform, timer, progress);
    if (!stream.isNeeded(faces))
      return false;
    std::optional<DeviceColumns> columns;
    if (job.device.kind == DeviceKind::Cuda && job.plan == 0) {
      columns.emplace(mesh, transform, job.device, result.device);
    } else {
      mesh = TetMesh(); // its memory serves the rasteriser
      faces.snapped.tets = nullptr;
    }
    reportTransform(transform, options, told);
    stream.write(faces, columns ? &*columns : nullptr, originMetadata(job), result, timer,
                 progress);
    reportTets(result.counts, tets, told);
    if (job.plan == 0)
      requireVoxels(whole && result.grids.front().activeVoxels == 0, options);
  }
  {
    StageTimer timer(told, "write");
    stream.commit(result, progress);
  }
  moveReport(told, report);
  return true;
}

void streamFaces(const VoxelizeJob& job, const SolidFaces& faces, const GridTransform& transform,
                 VoxelizeResult& result, Report& report, Progress& progress) {
  Stream stream(job, transform, false);
  {
    StageTimer timer(report, "voxelize");
    stream.write(faces, nullptr, originMetadata(job), result, timer, progress);
    if (job.plan == 0)
      requireVoxels(job.shard.isWhole() && result.grids.front().activeVoxels == 0,
                    streamOptions(job));
  }
  StageTimer timer(report, "write");
  stream.commit(result, progress);
}

bool streamTriangles(const VoxelizeJob& job, const std::vector<TriangleMesh>& meshes,
                     const std::map<std::string, std::string>& metadata, VoxelizeResult& result,
                     Report& report, Progress& progress) {
  if (canStreamTrees(job))
    return streamTrees(job, meshes, metadata, result, report, progress);
  const TriangleMesh& mesh = meshes.front();
  if (!canStream(job) || mesh.triangles.empty())
    return false;
  const VoxelizeOptions options = streamOptions(job);
  VoxelizeOptions used = options;
  std::map<std::string, std::string> all = originMetadata(job);
  for (const auto& [key, text] : metadata)
    all.emplace(key, text);
  for (bool first = true;; first = false) {
    const GridTransform transform = chooseTransform(mesh, used, job.solid);
    Stream stream(job, transform, false);
    if (first && !stream.mayBeNeeded(boxOf(mesh, job.solid)))
      return false;
    checkMesh(mesh);
    progress.stage("voxelize");
    initializeOpenVDB();
    Report told;
    double factor = 1;
    {
      StageTimer timer(told, "voxelize");
      const SolidFaces faces = solidFaces(mesh, job.solid, transform, timer, progress);
      if (!stream.isNeeded(faces) && first)
        return false;
      const bool byDevice = job.device.kind == DeviceKind::Cuda && job.plan == 0;
      if (byDevice && faces.holes) {
        if (!mustStream(job))
          return false;
        told.warn("device-unused", "shards of open meshes are found on the CPU");
      }
      const bool coarsens = mayCoarsen(options) && faces.counts.openEdges > 0;
      if (coarsens && (!job.shard.isWhole() || job.plan > 0))
        throw Error(Status::Usage, "`resolution`",
                    "of an open mesh is only known when the whole of it is voxelized",
                    "give shards `voxel_size`");
      reportTransform(transform, used, told);
      std::optional<DeviceColumns> columns;
      if (byDevice && !faces.holes)
        columns.emplace(mesh, *fillRuleOf(job.solid), transform, job.device, result.device);
      stream.write(faces, columns ? &*columns : nullptr, all, result, timer, progress);
      if (job.plan > 0) {
        result.openEdges = result.counts.openEdges;
        return true;
      }
      const GridInfo& grid = result.grids.front();
      if (coarsens && grid.activeVoxels > 0)
        factor = tooFine(VoxelBox{grid.boxMin, grid.boxMax}, options);
      if (factor == 1 && job.shard.isWhole())
        checkSolid(mesh, faces.boundary, job.solid, grid.activeVoxels, stream.surfaceVoxels(),
                   options, told);
    }
    if (factor == 1) {
      StageTimer timer(told, "write");
      stream.commit(result, progress);
    } else {
      coarsen(transform, factor, used);
      told.warnings.clear();
    }
    moveReport(told, report);
    result.openEdges = result.counts.openEdges;
    if (factor == 1)
      return true;
  }
}

} // namespace tetvdb
