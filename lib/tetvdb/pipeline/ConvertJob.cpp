// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/ConvertJob.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/InArena.h"
#include "tetvdb/core/ResidentBytes.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/io/TileFiles.h"
#include "tetvdb/io/TriangleWriter.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/VolumeStream.h"
#include "tetvdb/pipeline/ConvertInput.h"
#include "tetvdb/pipeline/VoxelizeOutput.h"
#include "tetvdb/surface/ExtractSurface.h"
#include "tetvdb/surface/TetSurface.h"
#include "tetvdb/volume/ChooseGrids.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fmt/format.h>
#include <tbb/task_arena.h>
#include <utility>

namespace tetvdb {
namespace {

// What converting by parts takes besides what depends on the limit: buffers, a 128^3 node and what
// is mapped of files; of each thread, pieces that are made ahead of their turn.
constexpr std::size_t kLeastBytes = std::size_t(64) << 20, kLeastBytesOfThread = std::size_t(8)
                                                                                 << 20;

bool readsArrays(const std::string& path) {
  return can(formatOf(volumeFormatOf(path)), FormatUse::ReadArrays);
}

void choose(const ConvertJob& job, Volume& volume) {
  if (job.grids.empty())
    return;
  openvdb::GridPtrVec& all = volume.grids().all;
  std::vector<std::string> names;
  for (const auto& grid : all)
    names.push_back(grid->getName());
  openvdb::GridPtrVec chosen;
  for (const std::size_t g : chooseGrids(names, job.grids, job.input))
    chosen.push_back(all[g]);
  all = std::move(chosen);
}

class Conversion {
public:
  Conversion(const ConvertJob& job, Report& report, Progress& progress)
      : job_(job), report_(report), progress_(progress), toVolume_(writes(FormatUse::WriteVolume)),
        toArrays_(writes(FormatUse::WriteArrays)), toTriangles_(writes(FormatUse::WriteTriangles)),
        toTets_(writes(FormatUse::WriteTets)), toTiles_(job.tileSize > 0) {}

  ConvertResult run() {
    check();
    if (job_.isVolume)
      fromVolume();
    else if (holdsTriangles(job_.input))
      fromTriangles();
    else
      fromTets();
    if (!toTiles_)
      for (const std::string& path : arrayFiles(job_.output))
        result_.outputs.push_back(written(path));
    return std::move(result_);
  }

private:
  void check() const {
    checkLevelsAndTiles();
    if (toTiles_)
      return;
    requireFormat(job_.output, {FormatUse::WriteTets, FormatUse::WriteTriangles,
                                FormatUse::WriteVolume, FormatUse::WriteArrays});
    const std::vector<std::string> outputs = arrayFiles(job_.output);
    for (const std::string& path : outputs)
      requireWritable(path);
    requireSeparateFiles(inputs(), outputs);
    if (job_.isVolume && toTets_)
      throw Error(Status::Usage, job_.output, "is a format of tetrahedra, and the input a volume",
                  "its surface becomes " + endingList(FormatUse::WriteTriangles));
    if (!job_.isVolume && (toVolume_ || toArrays_))
      throw Error(Status::Usage, job_.output, "is a format of volumes, and the input a mesh",
                  "make one with 'tetvdb voxelize'");
    if (!job_.isVolume && !job_.grids.empty())
      throw Error(Status::Usage, "`grid`", "chooses grids of a volume; the input is a mesh",
                  "leave it out");
    if (toTriangles_ && job_.grids.size() > 1)
      throw Error(Status::Usage, "`grid`", "the surface is that of one grid", "name one");
    if (toArrays_)
      checkArrayOptions(job_.output, job_.arrays, std::max<std::size_t>(job_.grids.size(), 1));
  }

  void checkLevelsAndTiles() const {
    if (!job_.isVolume && (toTiles_ || !job_.levels.isEmpty()))
      throw Error(Status::Usage, toTiles_ ? "`tiles`" : "`lod`",
                  "is of a volume; the input is a mesh", "leave it out");
    if (!job_.levels.isEmpty())
      checkLevels(job_.levels);
    if (toTiles_)
      requireTileFolder(job_.output, job_.tileSize, job_.levels, inputs());
    else if (!job_.levels.isEmpty() && !toVolume_)
      throw Error(Status::Usage, "`lod`", "is for .vdb and .nvdb files, and tiles", "leave it out");
  }

  std::vector<std::string> inputs() const {
    std::vector<std::string> all{job_.input};
    all.insert(all.end(), job_.arrayInput.pages.begin(), job_.arrayInput.pages.end());
    return all;
  }

  bool writes(FormatUse use) const { return formatForEnding(job_.output, use) != nullptr; }

  template <typename Work>
  auto stage(const char* name, const Work& work) {
    StageTimer timer(report_, name);
    progress_.stage(name);
    return work();
  }

  void fromTriangles() {
    if (!toTriangles_)
      throw Error(Status::Usage, job_.output, "is a format of tetrahedra, and the input triangles",
                  "make tets with 'tetvdb tetrahedralize', or write " +
                      endingList(FormatUse::WriteTriangles));
    const TriangleMesh mesh =
        stage("read", [&] { return readSoup(job_.input, &result_.input, report_, progress_); });
    write(mesh);
  }

  void fromTets() {
    result_.source = SolidSource::Tets;
    ReadOptions options;
    options.attributes = toTets_;
    options.timeStep = job_.timeStep;
    const TetMesh mesh = stage("read", [&] {
      return readTets(job_.input, options, {}, &result_.input, report_, progress_);
    });
    if (toTriangles_)
      return write(stage("extract", [&] { return tetSurface(mesh, progress_); }));
    result_.vertices = mesh.points.size();
    result_.tets = mesh.tetCount();
    stage("write", [&] { writeTetMesh(job_.output, mesh, progress_); });
  }

  void fromVolume() {
    result_.source = SolidSource::Volume;
    if (toTiles_ && isLargeVolume(job_.input)) {
      take(stage("write", [&] {
        return splitVolumeFile(job_.input, job_.grids, job_.output, job_.tileSize, progress_,
                               tileLevels());
      }));
      return;
    }
    if (toVolume_ && canConvertVolume(job_.input)) {
      result_.grids = stage("write", [&] {
        return convertVolumeFile({job_.input, job_.output, job_.grids, bytesOfParts(), job_.levels},
                                 progress_);
      });
      return;
    }
    Volume volume = stage("read", [&] { return readConverted(job_, report_, progress_); });
    if (!volume.unread.empty() && job_.grids.empty() && !readsArrays(job_.input))
      report_.partial = true;
    if (toTriangles_) {
      ExtractOptions options;
      options.grid = job_.grids.empty() ? std::string() : job_.grids.front();
      options.simplify = job_.simplify;
      options.maxMemory = memoryLeft(job_.maxMemory);
      return write(stage("extract", [&] { return extractSurface(volume, options, progress_); }));
    }
    if (toTiles_) {
      take(stage("write", [&] {
        return writeTileFiles(job_.output, job_.tileSize, volume, progress_, tileLevels());
      }));
      return;
    }
    if (!job_.levels.isEmpty())
      stage("levels", [&] {
        addDescribedLevels(volume, job_.levels, memoryLeft(job_.maxMemory), progress_);
      });
    result_.grids = describe(volume);
    stage("write", [&] {
      if (toArrays_)
        writeArrays(job_.output, volume, job_.arrays, progress_);
      else
        writeVolume(job_.output, volume, progress_);
    });
  }

  // What converting by parts may take.
  std::size_t bytesOfParts() const {
    if (job_.maxMemory == 0)
      return availableBytes();
    const std::size_t used = residentBytes();
    const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    // Compressed values are rarely more than so many times as large.
    const std::uintmax_t unpacked = 64 * std::filesystem::file_size(job_.input);
    const std::size_t least = used + static_cast<std::size_t>(std::min<std::uintmax_t>(
                                         kLeastBytes + threads * kLeastBytesOfThread, unpacked));
    if (job_.maxMemory < least)
      throw Error(Status::Limit, job_.input,
                  fmt::format("takes {:.0f} MB to be converted part by part, {:.0f} MB are allowed",
                              std::ceil(static_cast<double>(least) * 1e-6),
                              static_cast<double>(job_.maxMemory) * 1e-6),
                  "raise `max_memory`");
    return job_.maxMemory - used;
  }

  TileLevels tileLevels() const { return {job_.levels, memoryLeft(job_.maxMemory)}; }

  void take(TileFilesInfo&& files) {
    result_.grids = std::move(files.grids);
    result_.tileFiles = files.files;
    result_.outputs.push_back({job_.output, files.bytes});
  }

  void write(const TriangleMesh& mesh) {
    result_.vertices = mesh.points.size();
    result_.triangles = mesh.triangleCount();
    stage("write", [&] { writeTriangles(job_.output, mesh, progress_); });
  }

  const ConvertJob& job_;
  Report& report_;
  Progress& progress_;
  bool toVolume_, toArrays_, toTriangles_, toTets_, toTiles_;
  ConvertResult result_;
};

} // namespace

Volume readConverted(const ConvertJob& job, Report& report, Progress& progress) {
  if (!readsArrays(job.input)) {
    Volume volume = readVolumeInput(job.input, report, progress);
    choose(job, volume);
    return volume;
  }
  Volume volume = readArrays(job.input, job.arrayInput, progress);
  warnOfReading(volume, job.input, report);
  choose(job, volume);
  const openvdb::GridPtrVec& grids = volume.grids().all;
  if (!job.allowEmpty &&
      std::all_of(grids.begin(), grids.end(), [](const auto& grid) { return grid->empty(); }))
    throw Error(Status::Invalid, job.input, "has no voxel with another value than the background",
                "give another `background`");
  return volume;
}

ConvertResult run(const ConvertJob& job, Report& report, Progress& progress) {
  return inArena(job.threads, [&] { return Conversion(job, report, progress).run(); });
}

} // namespace tetvdb
