// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/PrepareMesh.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/InArena.h"
#include "tetvdb/fields/NeededArrays.h"
#include "tetvdb/io/SpoolCells.h"
#include "tetvdb/mesh/TetStatistics.h"
#include "tetvdb/pipeline/StreamOptions.h"
#include "tetvdb/pipeline/prepared/PreparedFiles.h"
#include "tetvdb/pipeline/prepared/PreparedIndex.h"
#include "tetvdb/pipeline/prepared/TetBuckets.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/SpooledBoundary.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <utility>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

// Tets of a bucket: more would not be faster.
constexpr std::uint64_t kMostTets = std::uint64_t(1) << 20;
// Bytes of a tet of a bucket while it is voxelized, arrays apart.
constexpr std::uint64_t kBytesPerTet = 250;
// More where its cell has shape functions.
constexpr std::uint64_t kBytesPerShapedTet = 40;

[[noreturn]] void refuse(const char* setting, const char* why) {
  throw Error(Status::Usage, setting, why, "leave it out, or voxelize the mesh as a whole");
}

void checkJob(const VoxelizeJob& job) {
  if (job.inputs.size() != 1 || !job.memory.empty())
    throw Error(Status::Usage, "", "one file is prepared at a time");
  const CellFilter& filter = job.filter;
  const CellFilter none;
  if (!filter.regions.empty() || !filter.exclude.empty() || filter.boxMin != none.boxMin ||
      filter.boxMax != none.boxMax)
    refuse("`region`, `exclude`, `bbox`", "choose cells of a mesh that is read as a whole");
  if (job.voxelize.fit.voxels != 0)
    refuse("`fit`", "is not for meshes that are prepared");
  if (!job.warp.array.empty())
    refuse("`warp`", "moves the points of a mesh that is read as a whole");
  if (job.smooth)
    refuse("`smooth`", "takes the cells around a point of a mesh that is read as a whole");
}

bool needsTets(const VoxelizeJob& job) {
  return !madeBy(job.grids, {GridMaker::Owner}).empty() || !job.fields.empty();
}

void turnSpooled(SpooledMesh& mesh, UpAxis up) {
  constexpr std::size_t kChunk = std::size_t(1) << 16;
  if (up == UpAxis::Z)
    return;
  std::vector<Vec3d> part;
  for (std::size_t done = 0; done < mesh.pointCount(); done += kChunk) {
    const Vec3d* from = mesh.points.as<Vec3d>() + done;
    part.assign(from, from + std::min(kChunk, mesh.pointCount() - done));
    turnUp(part, up);
    mesh.points.overwrite(done * sizeof(Vec3d), part.data(), part.size() * sizeof(Vec3d));
  }
}

// measure() of all tets; sums of doubles are taken by ranges.
TetStatistics measureSpooled(const SpooledMesh& mesh, std::size_t maxResident, Progress& progress) {
  TetStatistics sum;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  sum.boxMin = {kInfinity, kInfinity, kInfinity};
  sum.boxMax = {-kInfinity, -kInfinity, -kInfinity};
  eachTetRange(
      mesh, maxResident, progress,
      [&](std::size_t begin, std::size_t end) { return measure(cornersOf(mesh, begin, end)); },
      [&](const TetStatistics& part) {
        for (std::size_t k = 0; k < 3; ++k) {
          sum.boxMin[k] = std::min(sum.boxMin[k], part.boxMin[k]);
          sum.boxMax[k] = std::max(sum.boxMax[k], part.boxMax[k]);
        }
        sum.volume += part.volume;
        sum.boxVolume += part.boxVolume;
        sum.inverted += part.inverted;
        sum.flat += part.flat;
      });
  return sum;
}

bool isBeyondInt32(const SpooledArray& array) {
  if (emptyAttribute(array).values.index() != 3) // std::int64_t
    return false;
  const auto* values = array.values->as<std::int64_t>();
  return std::any_of(values, values + array.values->count<std::int64_t>(),
                     [](std::int64_t v) { return v < INT32_MIN || v > INT32_MAX; });
}

// Adds the ranges of the fields of one more bucket.
void addRanges(const BucketTets& tets, const FieldOptions& options, PreparedIndex& index) {
  if (options.empty())
    return;
  Report told; // said by those who voxelize
  const std::vector<Field> fields = resolveFields(tets.mesh, options, told);
  index.ranges.resize(fields.size());
  for (std::size_t i = 0; i < fields.size(); ++i) {
    PreparedRange& range = index.ranges[i];
    range.key = keyOf(fields[i]);
    range.range.add(fields[i].original);
    range.notFinite = range.notFinite || fields[i].notFinite > 0;
  }
}

class Preparation {
public:
  Preparation(const VoxelizeJob& job, const std::string& folder, Report& report, Progress& progress)
      : job_(job), report_(report), progress_(progress), folder_(folder, preparedContents()),
        parent_(fs::path(folder_.temporary()).parent_path().string()), mesh_(parent_) {}

  PreparedMesh run() {
    read();
    StageTimer timer(report_, "prepare");
    progress_.stage("prepare");
    limit_ = streamLimit(job_);
    maxResident_ = residentLimit();
    timer.part("measure");
    TetStatistics& statistics = index_.input.statistics;
    statistics = measureSpooled(mesh_, maxResident_, progress_);
    WorldBox box;
    box.min = statistics.boxMin;
    box.max = statistics.boxMax;
    const VoxelizeOptions options = streamOptions(job_);
    index_.transform = chooseTransform(box, options);
    reportTransform(index_.transform, options, report_);
    timer.part("boundary");
    findBoundary();
    reportTets(index_.counts, mesh_.tetCount(), report_);
    if (needsTets(job_)) {
      timer.part("nodes");
      writeBuckets(timer);
    }
    timer.part("write");
    writePreparedIndex(folder_.temporary(), index_);
    progress_.check();
    folder_.commit();
    return describePrepared(folder_.target());
  }

private:
  void read() {
    StageTimer timer(report_, "read");
    progress_.stage("read");
    const std::string& path = job_.inputs.front();
    timer.part(path);
    ReadOptions wanted = job_.read;
    wanted.attributes = !job_.fields.empty();
    wanted.arrays = neededArrays(job_.fields, job_.warp);
    InputInfo& input = index_.input;
    spoolCells(path, wanted, mesh_, input.format, report_, progress_);
    turnSpooled(mesh_, job_.up);
    index_.source = fs::path(path).filename().string();
    index_.up = job_.up;
    input.path = path;
    input.vertices = mesh_.pointCount();
    input.tets = mesh_.tetCount();
    input.cells = mesh_.cells;
  }

  // Half of what may be taken, so that what is not mapped has the other half.
  std::size_t residentLimit() const {
    return job_.maxMemory != 0 ? job_.maxMemory / 2 : availableBytes() / 2;
  }

  void findBoundary() {
    const SpooledBoundary boundary =
        spooledBoundary(mesh_, index_.transform, limit_ / 4, maxResident_, progress_);
    index_.counts.flipped = boundary.chain.flipped;
    index_.counts.dropped = boundary.chain.dropped;
    index_.counts.boundaryFaces = boundary.chain.faces.size();
    index_.boundaryPoints = boundary.points.size();
    index_.boundary = naming([&] { return writeBoundary(folder_.temporary(), boundary); });
  }

  void writeBuckets(StageTimer& timer) {
    std::uint64_t each = kBytesPerTet + (mesh_.hasShapes() ? kBytesPerShapedTet : 0);
    for (const SpooledArray& array : mesh_.arrays) {
      index_.arrays.push_back(
          {array.name, array.on, array.components, array.type, isBeyondInt32(array)});
      each += 2 * array.bytesEach();
    }
    index_.unread = mesh_.unread;
    index_.hasTets = true;
    index_.hasRegions = mesh_.regions.size() > 0;
    index_.hasShapes = mesh_.hasShapes();
    // By the limit itself and not by what is left of it, so that the parts are the same every time.
    const std::uint64_t most =
        job_.maxMemory == 0 ? kMostTets
                            : std::clamp<std::uint64_t>(job_.maxMemory / 10 / each, 1, kMostTets);
    const TetBuckets buckets(mesh_, index_.transform, most, parent_, limit_ / 8, maxResident_,
                             progress_);
    index_.nodeCount = buckets.nodes().size();
    index_.nodes = naming([&] { return writeNodes(folder_.temporary(), buckets.nodes()); });
    timer.part("tets");
    FieldOptions fields = job_.fields;
    fields.turnVectors = job_.up == UpAxis::Y;
    for (std::size_t b = 0; b < buckets.boxes().size(); ++b) {
      progress_.update(static_cast<double>(b) / static_cast<double>(buckets.boxes().size()));
      TetBucket bucket;
      bucket.box = buckets.boxes()[b];
      bucket.tets = buckets.tetsIn(b);
      if (bucket.tets > 0) {
        const BucketTets tets = buckets.tets(b);
        bucket.points = tets.mesh.points.size();
        bucket.cells = tets.mesh.curved.cells.size();
        bucket.cellNodes = tets.mesh.curved.nodes.size();
        addRanges(tets, fields, index_);
        bucket.file =
            naming([&] { return writeBucket(folder_.temporary(), bucketName(written_), tets); });
        ++written_;
      }
      index_.buckets.push_back(std::move(bucket));
    }
  }

  // Runs work(); errors name the folder that was asked for, not the temporary one.
  template <class Work>
  PreparedFile naming(const Work& work) {
    try {
      return work();
    } catch (const Error& error) {
      std::string text = error.what();
      const std::size_t at = text.find(folder_.temporary());
      if (at == std::string::npos)
        throw;
      throw Error(error.status(), "",
                  text.replace(at, folder_.temporary().size(), folder_.target()));
    }
  }

  const VoxelizeJob& job_;
  Report& report_;
  Progress& progress_;
  AtomicFolder folder_;
  std::string parent_;
  SpooledMesh mesh_;
  PreparedIndex index_;
  std::size_t limit_ = 0, maxResident_ = 0, written_ = 0;
};

} // namespace

PreparedMesh prepareMesh(const VoxelizeJob& job, const std::string& folder, Report& report,
                         Progress& progress) {
  return inArena(job.threads, [&] {
    checkJob(job);
    requireSeparateFiles(job.inputs, {folder + "/" + kPreparedIndex});
    return Preparation(job, folder, report, progress).run();
  });
}

bool isPreparedMesh(const std::string& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) &&
         fs::is_regular_file(fs::path(path) / kPreparedIndex, ignored);
}

PreparedMesh describePrepared(const std::string& folder) {
  const PreparedIndex index = readPreparedIndex(folder);
  PreparedMesh mesh;
  mesh.input = index.input;
  mesh.transform = index.transform;
  mesh.counts = index.counts;
  mesh.up = index.up;
  mesh.bytes = index.boundary.bytes + index.nodes.bytes;
  for (const TetBucket& bucket : index.buckets) {
    mesh.buckets += bucket.tets > 0 ? 1 : 0;
    mesh.mostTets = std::max(mesh.mostTets, bucket.tets);
    mesh.storedTets += bucket.tets;
    mesh.bytes += bucket.file.bytes;
  }
  for (const PreparedArray& array : index.arrays)
    mesh.arrays.push_back(array.name);
  return mesh;
}

} // namespace tetvdb
