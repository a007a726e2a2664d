// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/StreamTrees.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/fields/LevelSet.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/io/volume/TileFolder.h"
#include "tetvdb/io/volume/TreeWriter.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/pipeline/JobTrees.h"
#include "tetvdb/pipeline/MergeMeshes.h"
#include "tetvdb/pipeline/OriginMetadata.h"
#include "tetvdb/pipeline/PlannedStages.h"
#include "tetvdb/pipeline/StreamOptions.h"
#include "tetvdb/pipeline/VoxelizeOutput.h"
#include "tetvdb/volume/GridLevels.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/KeepResolution.h"
#include "tetvdb/voxelize/TreeBuilder.h"
#include "tetvdb/voxelize/TreeEstimate.h"
#include "tetvdb/voxelize/VoxelizeMaterials.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <memory>
#include <optional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <utility>
#include <variant>
#include <xxhash.h>

namespace tetvdb {
namespace {

// Trees of a part: more would not be faster.
constexpr std::size_t kMostPartBytes = std::size_t(1) << 30;

// What may wait in memory to be written; beyond it a file takes it.
constexpr std::size_t kMostSpoolBytes = std::size_t(32) << 20;

bool hasDistances(const VoxelizeJob& job) {
  return !madeBy(job.grids, {GridMaker::Distance}).empty();
}

// A hash over what a mesh holds.
class MeshMark {
public:
  template <typename T>
  void add(const std::vector<T>& values) {
    const XXH128_hash_t own = XXH3_128bits(values.data(), values.size() * sizeof(T));
    text_ += fmt::format(" {:016x}{:016x}", own.high64, own.low64);
  }
  void add(const std::string& text) { text_ += " " + text; }
  const std::string& text() const { return text_; }

private:
  std::string text_;
};

// What determines its values besides the array.
std::string textOf(const Field& field) {
  return fmt::format("{} {} {} {} {} {} {}", field.name, int(field.part), field.turned,
                     field.clamp.low, field.clamp.high, field.scale, field.offset);
}

std::string markOf(const TetMesh& mesh, const std::vector<Field>& fields) {
  MeshMark mark;
  mark.add(mesh.points);
  mark.add(mesh.tets);
  mark.add(mesh.cellOfTet);
  mark.add(mesh.regions);
  mark.add(mesh.curved.nodes);
  for (const Field& field : fields) {
    mark.add(textOf(field));
    for (const Field::Source& source : field.sources) {
      mark.add(std::to_string(source.component));
      std::visit([&](const auto& values) { mark.add(values); }, source.array->values);
    }
  }
  return mark.text();
}

// What is expected to be in memory at once where whole trees are made.
double occupancyBytes(const VoxelizeJob& job, const SolidFaces& faces) {
  std::vector<GridKind> kinds = madeBy(job.grids, {GridMaker::Occupancy, GridMaker::Owner});
  if (!shapesOf(job).grids.empty())
    kinds.push_back(GridKind::Mask);
  const TreeEstimate trees = estimateByBoundary(faces.snapped, faces.chain);
  return bytesOf(faces) + trees.bytes(kinds) + trees.levelBytes(job.levels, job.grids.size());
}

double ownerBytes(const VoxelizeJob& job, const SnappedMesh& snapped,
                  const std::vector<Field>& fields) {
  double bytes =
      24.0 * static_cast<double>(snapped.pointCount) + 16.0 * static_cast<double>(snapped.tetCount);
  if (!madeBy(job.grids, {GridMaker::Owner}).empty())
    bytes +=
        estimateByTets(snapped).bytes(madeBy(job.grids, {GridMaker::Occupancy, GridMaker::Owner}));
  if (!fields.empty()) {
    const PackOptions pack;
    const FieldBytes each = fieldBytes(fields, packsArrays(job) ? &pack : nullptr);
    const TreeEstimate tree = estimateByVolume(snapped);
    bytes +=
        (1 + levelShare(job.levels)) * (tree.leaves * each.leaf + tree.lowerNodes * each.lowerNode);
  }
  return bytes;
}

// The same of level set, fog and coverage.
double distanceBytes(const ShapeSolid& solid, ShapeOptions shapes) {
  if (shapes.halfWidth != kWholeBox)
    return shapeBytes(solid, shapes);
  shapes.halfWidth = kMinHalfWidth;
  return shapeBytes(solid, shapes) +
         wholeBoxBytes(wholeBox(solid.mesh, solid.faces, {}, 0), solid.faces.faces.size());
}

double reachOf(const VoxelizeJob& job) {
  if (isWholeBox(job))
    return kBeyondMesh;
  return hasDistances(job) ? job.shapes.halfWidth : 1;
}

// Of all nodes in a box.
double leavesIn(const VoxelizeJob& job, const WorldBox& box, const GridTransform& transform) {
  double leaves = 1;
  for (std::size_t k = 0; k < 3; ++k)
    leaves *=
        ((box.max[k] - box.min[k]) / transform.voxelSize[k] + 2 * reachOf(job)) / kLeafSize + 2;
  return leaves;
}

// Of nodes around triangles, before these are prepared for anything: about
// estimateBandLeaves().
double leavesAround(const VoxelizeJob& job, const TriangleMesh& mesh,
                    const GridTransform& transform) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.triangleCount(), 16384), 0.0,
      [&](const tbb::blocked_range<std::size_t>& range, double leaves) {
        for (std::size_t t = range.begin(); t != range.end(); ++t) {
          Vec3d corners[3];
          for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t k = 0; k < 3; ++k)
              corners[c][k] = mesh.points[mesh.triangles[3 * t + c]][k] / transform.voxelSize[k];
          const Vec3d n = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
          leaves += (reachOf(job) * length(n) +
                     kLeafSize * (std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2])) / 2) /
                        kVoxelsInLeaf +
                    1;
        }
        return leaves;
      },
      std::plus<>());
}

// A way to the file by one voxel size.
class TreeStream {
public:
  TreeStream(const VoxelizeJob& job, Report& told, Progress& progress)
      : job_(job), told_(told), progress_(progress) {}

  // False: trees of at most so many leaves cannot be too large.
  static bool mayBeNeeded(const VoxelizeJob& job, double leaves) {
    std::vector<GridKind> kinds = job.grids;
    kinds.resize(kinds.size() + job.fields.requests.size() + (job.fields.all ? 64 : 0) + 1,
                 GridKind::Density);
    const TreeEstimate trees{leaves, leaves / 64 + 64};
    return mustStream(job) ||
           bytesWithCopies(job, trees.bytes(kinds) + trees.levelBytes(job.levels, kinds.size())) >
               static_cast<double>(streamLimit(job)) / 2;
  }
  // `bytes`: of whole trees.
  static bool isNeeded(const VoxelizeJob& job, double bytes) {
    return mustStream(job) || bytesWithCopies(job, bytes) > static_cast<double>(streamLimit(job));
  }

  // What the grids are found from, prepared for all boxes. `distances` is trimmed where level sets
  // need it; `shares`: place for what coverage is found from. Returns whether the job ends here: it
  // asks for a plan, which `result` has then.
  bool prepare(TreeInputs& inputs, std::optional<ShapeSolid>& distances,
               std::optional<ShapeSolid>& shares, VoxelizeResult& result, StageTimer& timer) {
    if (contains(job_.grids, GridKind::Coverage))
      inputs.shares = &shares.emplace(*distances);
    if (hasDistances(job_)) {
      timer.part("trim");
      trimShape(*distances, result.shapes.trim, told_, progress_);
      inputs.distances = &*distances;
    }
    timer.part("cubes");
    trees_.emplace(job_, inputs, progress_);
    if (job_.plan > 0)
      result.plan = planShards(trees_->rootCubes(), trees_->weights(), job_.plan);
    return job_.plan > 0;
  }
  JobTrees& trees() { return *trees_; }

  // `mark`: of the mesh. `open`: the solid of distances, if holes are closed.
  void write(std::map<std::string, std::string> metadata, const GridTransform& transform,
             const std::string& mark, ShapeSolid* open, VoxelizeResult& result, StageTimer& timer) {
    const CubeRange range =
        job_.shard.isWhole() ? trees_->all()
                             : shardRanges(trees_->weights(), job_.shard.count)[job_.shard.index];
    const std::size_t left = streamLimit(job_);
    std::optional<TreeLevels> levels; // of one file
    if (!job_.levels.isEmpty() && job_.tileSize == 0)
      levels.emplace(*trees_, job_.levels, left / 2, progress_);
    trees_->limitParts(std::min(left / (job_.levels.isEmpty() ? 3 : 6), kMostPartBytes));
    progress_.stage(kStreamStage);
    // Every pass finds the distances of all; the last one also writes them, and that for the fog's
    // depth nearly always stops early.
    const bool fog = contains(job_.grids, GridKind::Fog);
    const double passes = 1.5 + (open != nullptr ? 1 : 0) + (fog ? 0.2 : 0);
    const ProgressShare whole(progress_, 0, 1);
    double begun = 0;
    const auto nextPass = [&](double length) {
      const double from = begun / passes;
      begun += length;
      return whole.part(from, begun / passes);
    };
    if (open != nullptr) {
      timer.part("holes");
      trees_->addCaps(*open, isWholeBox(job_) ? trees_->all() : range, nextPass(1), progress_);
    }
    if (isWholeBox(job_)) {
      timer.part("largest distance");
      trees_->findLargestDistance(progress_);
    }
    if (fog) {
      timer.part("depth");
      trees_->findFogDepth(nextPass(0.2), progress_);
    }
    timer.part("stream");
    std::size_t own = 0; // grids that are no levels
    if (job_.tileSize > 0) {
      const openvdb::GridPtrVec grids = trees_->make(NodeBox{}, progress_);
      own = grids.size();
      tiles_.emplace(job_.output, job_.tileSize, std::move(metadata), grids,
                     TileLevels{job_.levels, left / 2});
      tiles_->add(*trees_, std::min(left / 16, kMostSpoolBytes), nextPass(1.5), progress_);
      result.grids = tiles_->grids();
    } else {
      result.grids =
          writeFile(std::move(metadata), transform, mark, range, left, levels, nextPass(1.5));
      own = result.grids.size() - (levels ? levels->gridCount() : 0);
    }
    result.shapes.coverage = trees_->coverageSum();
    warnOfOverlap(result.shapes.coverage, told_);
    checkValues(job_,
                {result.grids.begin(), result.grids.begin() + static_cast<std::ptrdiff_t>(own)},
                told_);
  }
  void commit(VoxelizeResult& result) {
    StageTimer timer(told_, "write");
    progress_.check();
    if (tiles_) {
      addTileFiles(tiles_->commit(progress_), job_.output, result);
      return;
    }
    writer_->commit(progress_);
    result.outputs.push_back(written(job_.output));
  }

private:
  // One file, of a shard or of all; returns what describe() says of its grids.
  std::vector<GridInfo> writeFile(std::map<std::string, std::string> metadata,
                                  const GridTransform& transform, const std::string& mark,
                                  const CubeRange& range, std::size_t left,
                                  std::optional<TreeLevels>& levels, const ProgressShare& share) {
    TreeWriterOptions options;
    if (!job_.shard.isWhole()) {
      options.spool.part = true;
      options.openFirstTile = false; // that of the whole volume
      const std::string what =
          mark + fmt::format(" {}", hasDistances(job_) ? job_.shapes.halfWidth : 0);
      partMetadata(job_, transform, what).add(metadata);
      trees_->restrict(range);
    }
    const std::size_t grids = std::max<std::size_t>(job_.grids.size(), 1);
    options.spool.inMemory = std::min(left / 16 / grids, kMostSpoolBytes);
    if (levels)
      options.moreGrids = levels->gridCount();
    if (writesNvdb(job_))
      writer_ = std::make_unique<TreeNvdbWriter>(job_.output, options);
    else
      writer_ = std::make_unique<TreeVdbWriter>(job_.output, std::move(metadata), options);
    const auto coarser = [&] {
      openvdb::GridPtrVec made = levels->finish();
      finishLevels(job_, made);
      return made;
    };
    TreeSource& passed = levels ? static_cast<TreeSource&>(*levels) : *trees_;
    return writer_->write(passed, levels ? TreeWriter::MoreGrids(coarser) : nullptr, share,
                          progress_);
  }

  const VoxelizeJob& job_;
  Report& told_;
  Progress& progress_;
  std::optional<JobTrees> trees_;
  std::unique_ptr<TreeWriter> writer_;
  std::optional<TileFolder> tiles_;
};

// Of occupancy alone, or of coverage where this is all.
void requireAnything(const VoxelizeJob& job, const VoxelizeResult& result, const JobTrees& trees,
                     const VoxelizeOptions& options) {
  if (!job.shard.isWhole())
    return;
  if (job.grids == std::vector<GridKind>{GridKind::Coverage})
    requireVoxels(result.grids.front().activeVoxels == 0, options);
  else if (!job.grids.empty())
    requireVoxels(trees.insideVoxels() == 0, options);
  else
    requireVoxels(!trees.anyOwned(), options);
}

} // namespace

bool canStreamTrees(const VoxelizeJob& job) {
  const bool values =
      !madeBy(job.grids, {GridMaker::Owner, GridMaker::Distance, GridMaker::Share}).empty() ||
      !job.fields.empty();
  return mayStream(job) && (values || writesNvdb(job)) && job.device.kind != DeviceKind::Cuda;
}

bool streamTrees(const VoxelizeJob& job, const TetMesh& mesh, VoxelizeResult& result,
                 Report& report, Progress& progress) {
  if (mesh.tets.empty())
    return false;
  const VoxelizeOptions options = streamOptions(job);
  const GridTransform transform = chooseTransform(mesh, options);
  if (!TreeStream::mayBeNeeded(job, leavesIn(job, boxOfUsed(mesh.points, mesh.tets), transform)))
    return false;
  checkTets(mesh, options);
  progress.stage("voxelize");
  initializeOpenVDB();
  Report told;
  TreeStream stream(job, told, progress);
  {
    StageTimer timer(told, "voxelize");
    std::vector<Field> fields;
    if (!job.fields.empty()) {
      FieldOptions wanted = job.fields;
      wanted.turnVectors = job.up == UpAxis::Y;
      fields =
          resolveFields(mesh, wanted, told, job.fieldRanges.empty() ? nullptr : &job.fieldRanges);
    }
    const ShapeOptions shapes = shapesOf(job);
    const bool owners = !madeBy(job.grids, {GridMaker::Owner}).empty();
    const bool byFaces =
        !shapes.grids.empty() || (!owners && !madeBy(job.grids, {GridMaker::Occupancy}).empty());
    std::optional<SolidFaces> faces;
    std::optional<SnappedMesh> own;
    if (byFaces) {
      faces.emplace(solidFaces(mesh, transform, timer, progress));
    } else {
      timer.part("snap");
      own.emplace(snapMesh(mesh, transform, progress));
    }
    const SnappedMesh& snapped = faces ? faces->snapped : *own;
    std::optional<ShapeSolid> distances, shares;
    double bytes = faces ? occupancyBytes(job, *faces) : 0;
    if (owners || !fields.empty())
      bytes += ownerBytes(job, snapped, fields);
    if (!shapes.grids.empty()) {
      timer.part("boundary");
      distances.emplace(shapeSolid(mesh, transform, progress));
      bytes += distanceBytes(*distances, shapes);
    }
    if (!TreeStream::isNeeded(job, bytes))
      return false;
    reportTransform(transform, options, told);
    result.transform = transform;
    if (faces)
      result.counts = faces->counts;
    if (owners)
      result.counts.boundaryFaces = 0; // the grids are found without
    TreeInputs inputs;
    inputs.transform = transform;
    if (faces)
      inputs.faces = {&*faces};
    std::optional<WholeTets> tets;
    if (owners || !fields.empty()) {
      timer.part("nodes");
      inputs.tets = &tets.emplace(mesh, snapped, &fields, progress);
    }
    if (!fields.empty())
      inputs.fields = &fields;
    if (stream.prepare(inputs, distances, shares, result, timer))
      return true;
    stream.write(originMetadata(job), transform, markOf(mesh, fields), nullptr, result, timer);
    if (!faces) {
      const OrientationCounts counts = countOrientations(snapped);
      result.counts.flipped = counts.flipped;
      result.counts.dropped = counts.dropped;
    }
    reportTets(result.counts, mesh.tetCount(), told);
    stream.trees().sampled().warn(fields, told);
    requireAnything(job, result, stream.trees(), options);
  }
  stream.commit(result);
  moveReport(told, report);
  return true;
}

void streamTrees(const VoxelizeJob& job, const PreparedInputs& mesh, VoxelizeResult& result,
                 Report& report, Progress& progress) {
  TreeStream stream(job, report, progress);
  {
    StageTimer timer(report, "voxelize");
    std::optional<ShapeSolid> distances, shares;
    if (!shapesOf(job).grids.empty())
      distances.emplace(shapeSolid(mesh.points, *mesh.faces));
    TreeInputs inputs;
    inputs.transform = mesh.transform;
    if (mesh.faces)
      inputs.faces = {&*mesh.faces};
    inputs.tets = mesh.tets;
    inputs.fields = mesh.fields;
    if (stream.prepare(inputs, distances, shares, result, timer))
      return;
    std::string mark = mesh.mark;
    for (std::size_t i = 0; mesh.fields != nullptr && i < mesh.fields->size(); ++i)
      mark += textOf((*mesh.fields)[i]);
    stream.write(originMetadata(job), mesh.transform, mark, nullptr, result, timer);
    if (mesh.fields != nullptr)
      stream.trees().sampled().warn(*mesh.fields, report);
    requireAnything(job, result, stream.trees(), streamOptions(job));
  }
  stream.commit(result);
}

namespace {

double surfaceVoxels(const SolidFaces& faces) {
  return estimateByBoundary(faces.snapped, faces.chain).leaves * kLeafSize * kLeafSize;
}

SnapCounts countsOf(const std::vector<SolidFaces>& solids) {
  SnapCounts sum;
  for (const SolidFaces& faces : solids) {
    sum.boundaryFaces += faces.counts.boundaryFaces;
    sum.openEdges += faces.counts.openEdges;
  }
  return sum;
}

// By how much voxels must become larger.
double factorOf(const VoxelizeJob& job, const std::vector<SolidFaces>& solids,
                const VoxelizeOptions& options, const GridTransform& transform,
                Progress& progress) {
  if (!mayCoarsen(options) || countsOf(solids).openEdges == 0)
    return 1;
  if (!job.shard.isWhole() || job.plan > 0)
    throw Error(Status::Usage, "`resolution`",
                "of an open mesh is only known when the whole of it is voxelized",
                "give shards `voxel_size`");
  openvdb::CoordBBox box; // of what is inside
  for (const SolidFaces& faces : solids) {
    OccupancySource source(faces.snapped, faces.chain, faces.fill(), job.voxelize.rule, progress);
    box.expand(insideBox(source, transform));
  }
  VoxelBox voxels;
  for (std::size_t k = 0; k < 3; ++k) {
    voxels.low[k] = box.min()[k];
    voxels.high[k] = box.max()[k];
  }
  return box.empty() ? 1 : tooFine(voxels, options);
}

// Of each mesh by itself, as its own voxelization would say it.
void checkMaterials(const VoxelizeJob& job, const std::vector<TriangleMesh>& meshes,
                    const std::vector<SolidFaces>& solids, const JobTrees& trees,
                    const VoxelizeOptions& options, Report& report) {
  VoxelizeOptions each = options;
  each.allowEmpty = true;
  bool empty = true;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const std::uint64_t voxels = trees.materialVoxels()[i];
    Report own;
    checkSolid(meshes[i], solids[i].boundary, job.solid, voxels, surfaceVoxels(solids[i]), each,
               own);
    noteMaterial(job.inputs[i], voxels == 0, own, report);
    empty = empty && voxels == 0;
  }
  requireMaterials(empty, options);
}

} // namespace

bool streamTrees(const VoxelizeJob& job, const std::vector<TriangleMesh>& meshes,
                 const std::map<std::string, std::string>& metadata, VoxelizeResult& result,
                 Report& report, Progress& progress) {
  const bool materials = contains(job.grids, GridKind::Material);
  if (std::any_of(meshes.begin(), meshes.end(), [](const auto& m) { return m.triangles.empty(); }))
    return false;
  if (materials && job.voxelize.rule != VoxelRule::Centre)
    return false; // which is refused there
  const VoxelizeOptions options = streamOptions(job);
  const ShapeOptions shapes = shapesOf(job);
  VoxelizeOptions used = options;
  WorldBox box;
  for (const TriangleMesh& mesh : meshes)
    box.add(boxOf(mesh, job.solid));
  GridTransform transform = chooseTransform(box, used, job.solid);
  double around = 0;
  for (const TriangleMesh& mesh : meshes) {
    checkMesh(mesh);
    around += leavesAround(job, mesh, transform);
  }
  const double most = leavesIn(job, box, transform);
  if (!TreeStream::mayBeNeeded(job, isWholeBox(job) ? most : std::min(most, 2 * around)))
    return false;
  std::optional<TriangleMesh> joined;
  if (meshes.size() > 1 && !shapes.grids.empty()) {
    Report mixedUnits; // which were reported when the files were read
    joined.emplace(mergeMeshes(std::vector<TriangleMesh>(meshes), mixedUnits));
  }
  const TriangleMesh& whole = joined ? *joined : meshes.front();
  progress.stage("voxelize");
  initializeOpenVDB();
  Report told;
  TreeStream stream(job, told, progress);
  {
    StageTimer timer(told, "voxelize");
    std::vector<SolidFaces> solids;
    std::optional<ShapeSolid> distances, shares;
    for (bool first = true;; first = false) {
      solids.clear();
      double bytes = 0;
      for (const TriangleMesh& mesh : meshes) {
        solids.push_back(solidFaces(mesh, job.solid, transform, timer, progress));
        bytes += occupancyBytes(job, solids.back());
      }
      if (!shapes.grids.empty()) {
        timer.part("boundary");
        distances.emplace(shapeSolid(whole, job.solid, contains(job.grids, GridKind::Coverage),
                                     transform, progress));
        bytes += distanceBytes(*distances, shapes);
      }
      if (first && !TreeStream::isNeeded(job, bytes))
        return false;
      const double factor = factorOf(job, solids, options, transform, progress);
      if (factor == 1)
        break;
      coarsen(transform, factor, used);
      transform = chooseTransform(box, used, job.solid);
    }
    reportTransform(transform, used, told);
    result.transform = transform;
    result.counts = countsOf(solids);
    result.openEdges = result.counts.openEdges;
    TreeInputs inputs;
    inputs.transform = transform;
    for (const SolidFaces& faces : solids)
      inputs.faces.push_back(&faces);
    if (stream.prepare(inputs, distances, shares, result, timer))
      return true;
    std::map<std::string, std::string> all = originMetadata(job);
    for (const auto& [key, text] : metadata)
      all.emplace(key, text);
    std::string mark;
    for (const SolidFaces& faces : solids)
      mark += (mark.empty() ? "" : " ") + markOf(faces);
    const bool open = hasDistances(job) && distances->boundary.has_value();
    stream.write(all, transform, mark, open ? &*distances : nullptr, result, timer);
    if (job.shard.isWhole() && materials) {
      checkMaterials(job, meshes, solids, stream.trees(), options, told);
    } else if (job.shard.isWhole()) {
      VoxelizeOptions checks = options;
      const bool coverageOnly = job.grids == std::vector<GridKind>{GridKind::Coverage};
      checks.allowEmpty = checks.allowEmpty || coverageOnly;
      checkSolid(meshes.front(), solids.front().boundary, job.solid, stream.trees().insideVoxels(),
                 surfaceVoxels(solids.front()), checks, told);
      requireAnything(job, result, stream.trees(), options);
    }
  }
  stream.commit(result);
  moveReport(told, report);
  return true;
}

} // namespace tetvdb
