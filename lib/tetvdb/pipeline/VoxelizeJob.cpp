// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/VoxelizeJob.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Version.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/pipeline/MergeMeshes.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <string_view>
#include <tbb/task_arena.h>
#include <unistd.h>
#include <utility>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

std::string lowerExtension(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

void requireExtension(const std::string& path, std::initializer_list<std::string_view> known,
                      std::string_view advice) {
  const std::string extension = lowerExtension(path);
  if (std::find(known.begin(), known.end(), extension) != known.end())
    return;
  throw Error(Status::Usage, path,
              extension.empty() ? "the output's name has no extension"
                                : "cannot write files that end in '" + extension + "'",
              advice);
}

void requireNoInput(const std::string& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    std::error_code ignored;
    if (fs::equivalent(output, input, ignored))
      throw Error(Status::Usage, output, "is an input as well as the output",
                  "choose another name");
  }
}

void checkOutputs(const VoxelizeJob& job) {
  if (job.inputs.empty())
    throw Error(Status::Usage, "", "no input was given");
  if (job.output.empty() && job.meshOutput.empty())
    throw Error(Status::Usage, "", "no output was given", "name one with -o OUT.vdb");
  if (!job.output.empty()) {
    requireExtension(job.output, {".vdb", ".nvdb"}, "name it .vdb or .nvdb");
    requireNoInput(job.output, job.inputs);
    requireWritable(job.output);
  }
  if (!job.meshOutput.empty()) {
    requireExtension(job.meshOutput, {".msh", ".mesh", ".vtu"}, "name it .msh, .mesh or .vtu");
    requireNoInput(job.meshOutput, job.inputs);
    requireWritable(job.meshOutput);
  }
}

void turnUp(TetMesh& mesh, UpAxis up) {
  if (up == UpAxis::Z)
    return;
  for (Vec3d& p : mesh.points)
    p = {p[0], p[2], -p[1]};
}

std::size_t residentBytes() {
  std::size_t total = 0;
  std::size_t resident = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%zu %zu", &total, &resident) != 2)
      resident = 0;
    std::fclose(file);
  }
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

std::string megabytes(std::size_t bytes) {
  return std::to_string((bytes >> 20) + 1) + " MB";
}

// What --max-memory leaves for the voxels once the mesh is there.
std::size_t memoryLeft(std::size_t limit) {
  if (limit == 0)
    return 0;
  const std::size_t used = residentBytes();
  if (used >= limit)
    throw Error(Status::Limit, "",
                "the mesh alone takes " + megabytes(used) + " of the " + megabytes(limit) +
                    " allowed",
                "raise --max-memory, or read a part with --region or --bbox");
  return limit - used;
}

std::string fileNames(const std::vector<std::string>& paths) {
  std::string names;
  for (const std::string& path : paths) {
    if (!names.empty())
      names += ", ";
    names += fs::path(path).filename().string();
  }
  return names;
}

void describeOrigin(const VoxelizeJob& job, Volume& volume) {
  volume.metadata["creator"] = std::string("TetVDB ") + version();
  volume.metadata["source"] = fileNames(job.inputs);
  if (!job.units.empty())
    volume.metadata["units"] = job.units;
  if (job.up == UpAxis::Y)
    volume.metadata["up_axis"] = "y";
  if (!job.half)
    return;
  for (const auto& grid : volume.grids().all)
    if (grid->isType<openvdb::FloatGrid>())
      grid->setSaveFloatAsHalf(true);
}

// An error about one input names its file.
Error withPath(const Error& error, const std::string& path) {
  std::string text = error.what();
  if (text.find(path) != std::string::npos)
    return error;
  if (text.rfind("mesh: ", 0) == 0)
    text.erase(0, 6);
  return {error.status(), path, text};
}

OutputInfo written(const std::string& path) {
  std::error_code ignored;
  return {path, static_cast<std::uint64_t>(fs::file_size(path, ignored))};
}

TetMesh readAll(const VoxelizeJob& job, VoxelizeResult& result, Report& report,
                Progress& progress) {
  StageTimer timer(report, "read");
  progress.stage("read");
  std::vector<TetMesh> meshes;
  for (const std::string& input : job.inputs) {
    InputInfo info;
    timer.part(input);
    meshes.push_back(readTets(input, job.read, job.filter, &info, report, progress));
    result.tets += info.tets;
    result.volume += info.statistics.volume;
    result.inputs.push_back(std::move(info));
  }
  TetMesh mesh = mergeMeshes(std::move(meshes), report);
  turnUp(mesh, job.up);
  return mesh;
}

Volume makeVolume(const VoxelizeJob& job, const TetMesh& mesh, VoxelizeResult& result,
                  Report& report, Progress& progress) {
  VoxelizeOptions options = job.voxelize;
  options.maxMemory = memoryLeft(job.maxMemory);
  progress.stage("voxelize");
  Voxelization made = voxelize(mesh, options, report, progress);
  result.counts = made.counts;
  result.transform = made.transform;
  result.path = made.path;
  describeOrigin(job, made.volume);
  return std::move(made.volume);
}

void writeOutputs(const VoxelizeJob& job, const TetMesh& mesh, Volume& volume,
                  VoxelizeResult& result, Report& report, Progress& progress) {
  StageTimer timer(report, "write");
  progress.stage("write");
  if (!job.meshOutput.empty())
    writeTetMesh(job.meshOutput, mesh, progress);
  if (!job.output.empty()) {
    try {
      writeVolume(job.output, volume, progress);
    } catch (...) {
      if (!job.meshOutput.empty())
        ::unlink(job.meshOutput.c_str()); // nothing, or everything
      throw;
    }
    result.outputs.push_back(written(job.output));
  }
  if (!job.meshOutput.empty())
    result.outputs.push_back(written(job.meshOutput));
}

VoxelizeResult runHere(const VoxelizeJob& job, Report& report, Progress& progress) {
  checkOutputs(job);
  VoxelizeResult result;
  TetMesh mesh = readAll(job, result, report, progress);
  progress.check();
  Volume volume;
  if (!job.output.empty()) {
    volume = makeVolume(job, mesh, result, report, progress);
    if (job.meshOutput.empty())
      mesh = TetMesh(); // its memory serves the writer
    for (const auto& grid : volume.grids().all)
      openFirstTile(*grid);
    result.grids = describe(volume);
  }
  progress.check();
  writeOutputs(job, mesh, volume, result, report, progress);
  return result;
}

} // namespace

void requireWritable(const std::string& path) {
  const AtomicFile probe(path);
}

TetMesh readTets(const std::string& path, const ReadOptions& options, const CellFilter& filter,
                 InputInfo* info, Report& report, Progress& progress) try {
  const std::size_t warningsBefore = report.warnings.size();
  MeshFormat format = MeshFormat::Unknown;
  CellMesh cells = readCells(path, options, report, progress, &format);
  if (info != nullptr) {
    info->path = path;
    info->format = format;
    info->vertices = cells.points.size();
    for (const CellRun& run : cells.runs)
      info->cells[run.fileType] += run.count;
  }
  progress.check();
  TetMesh mesh = splitCells(std::move(cells), filter, report, progress);
  for (std::size_t i = warningsBefore; i < report.warnings.size(); ++i)
    report.warnings[i].text = path + ": " + report.warnings[i].text;
  if (info != nullptr) {
    info->tets = mesh.tetCount();
    info->statistics = measure(mesh);
  }
  return mesh;
} catch (const Error& error) {
  if (error.status() == Status::Cancelled)
    throw;
  throw withPath(error, path);
}

VoxelizeResult run(const VoxelizeJob& job, Report& report, Progress& progress) {
  if (job.threads <= 0)
    return runHere(job, report, progress);
  tbb::task_arena arena(job.threads);
  return arena.execute([&] { return runHere(job, report, progress); });
}

} // namespace tetvdb
