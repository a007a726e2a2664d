// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/VoxelizeJob.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Version.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/io/TriangleWriter.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/pipeline/MergeMeshes.h"
#include "tetvdb/volume/Grids.h"

#include <filesystem>
#include <fmt/format.h>
#include <tbb/task_arena.h>
#include <unistd.h>
#include <utility>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

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
    requireExtension(job.meshOutput,
                     {".msh", ".mesh", ".vtu", ".stl", ".obj", ".ply", ".off", ".3mf"},
                     "name it .msh, .mesh or .vtu for tets, .stl, .obj, .ply, .off or .3mf for "
                     "triangles");
    requireNoInput(job.meshOutput, job.inputs);
    requireWritable(job.meshOutput);
  }
}

void turnUp(std::vector<Vec3d>& points, UpAxis up) {
  if (up == UpAxis::Z)
    return;
  for (Vec3d& p : points)
    p = {p[0], p[2], -p[1]};
}

// Whether the inputs hold triangles; one job takes one kind.
bool inputsHoldTriangles(const VoxelizeJob& job) {
  const bool first = holdsTriangles(job.inputs.front());
  for (const std::string& input : job.inputs)
    if (holdsTriangles(input) != first)
      throw Error(Status::Usage, input,
                  fmt::format("holds {}, but {} holds {}", first ? "tetrahedra" : "triangles",
                              job.inputs.front(), first ? "triangles" : "tetrahedra"),
                  "voxelize them one by one");
  const CellFilter& filter = job.filter;
  const CellFilter none;
  if (first && !(filter.regions.empty() && filter.exclude.empty() && filter.boxMin == none.boxMin &&
                 filter.boxMax == none.boxMax))
    throw Error(Status::Usage, "--region, --exclude, --bbox",
                "choose cells of a solid mesh; the input is triangles", "leave them out");
  if (!job.meshOutput.empty() && first != writesTriangles(job.meshOutput))
    throw Error(Status::Usage, job.meshOutput,
                first ? "cannot hold the triangles of the input" : "cannot hold tetrahedra",
                first ? "name it .stl, .obj, .ply, .off or .3mf" : "name it .msh, .mesh or .vtu");
  return first;
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

// Reads every input by read(path, info), and lays them together.
template <typename Mesh, typename Read>
Mesh readAll(const VoxelizeJob& job, VoxelizeResult& result, Report& report, Progress& progress,
             const Read& read) {
  StageTimer timer(report, "read");
  progress.stage("read");
  std::vector<Mesh> meshes;
  for (const std::string& input : job.inputs) {
    InputInfo info;
    timer.part(input);
    meshes.push_back(read(input, info));
    result.tets += info.tets;
    result.volume += info.statistics.volume;
    result.inputs.push_back(std::move(info));
  }
  Mesh mesh = mergeMeshes(std::move(meshes), report);
  turnUp(mesh.points, job.up);
  return mesh;
}

void clean(const VoxelizeJob& job, TriangleMesh& mesh, VoxelizeResult& result, Report& report,
           Progress& progress) {
  StageTimer timer(report, "clean");
  progress.stage("clean");
  result.cleaned = cleanTriangles(mesh, job.clean, progress);
  result.triangles = mesh.triangleCount();
  if (mesh.triangles.empty())
    throw Error(Status::Invalid, "",
                "every face of the mesh is degenerate: two of its corners coincide");
  if (result.cleaned.insideOut)
    report.warn("inside-out", "the mesh was inside out and was turned");
  else if (result.cleaned.flippedFaces > 0)
    report.warn("flipped-faces", fmt::format("{} of {} faces looked the wrong way and were turned",
                                             result.cleaned.flippedFaces, result.triangles));
}

template <typename Voxelize>
Volume makeVolume(const VoxelizeJob& job, VoxelizeResult& result, const Voxelize& voxelizeMesh) {
  VoxelizeOptions options = job.voxelize;
  options.maxMemory = memoryLeft(job.maxMemory);
  Voxelization made = voxelizeMesh(options);
  result.counts = made.counts;
  result.transform = made.transform;
  result.path = made.path;
  describeOrigin(job, made.volume);
  for (const auto& grid : made.volume.grids().all)
    openFirstTile(*grid);
  result.grids = describe(made.volume);
  return std::move(made.volume);
}

template <typename WriteMesh>
void writeOutputs(const VoxelizeJob& job, const WriteMesh& writeMesh, Volume& volume,
                  VoxelizeResult& result, Report& report, Progress& progress) {
  StageTimer timer(report, "write");
  progress.stage("write");
  if (!job.meshOutput.empty())
    writeMesh();
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

void runTets(const VoxelizeJob& job, VoxelizeResult& result, Report& report, Progress& progress) {
  TetMesh mesh = readAll<TetMesh>(
      job, result, report, progress, [&](const std::string& path, InputInfo& info) {
        return readTets(path, job.read, job.filter, &info, report, progress);
      });
  progress.check();
  Volume volume;
  if (!job.output.empty()) {
    volume = makeVolume(job, result, [&](const VoxelizeOptions& options) {
      return voxelize(mesh, options, report, progress);
    });
    if (job.meshOutput.empty())
      mesh = TetMesh(); // its memory serves the writer
  }
  progress.check();
  writeOutputs(
      job, [&] { writeTetMesh(job.meshOutput, mesh, progress); }, volume, result, report, progress);
}

void runTriangles(const VoxelizeJob& job, VoxelizeResult& result, Report& report,
                  Progress& progress) {
  TriangleMesh mesh = readAll<TriangleMesh>(job, result, report, progress,
                                            [&](const std::string& path, InputInfo& info) {
                                              return readSoup(path, &info, report, progress);
                                            });
  progress.check();
  clean(job, mesh, result, report, progress);
  Volume volume;
  if (!job.output.empty()) {
    volume = makeVolume(job, result, [&](const VoxelizeOptions& options) {
      return voxelize(mesh, job.solid, options, report, progress);
    });
    if (job.units.empty() && !mesh.units.empty())
      volume.metadata["units"] = mesh.units;
  }
  progress.check();
  writeOutputs(
      job, [&] { writeTriangles(job.meshOutput, mesh, progress); }, volume, result, report,
      progress);
}

VoxelizeResult runHere(const VoxelizeJob& job, Report& report, Progress& progress) {
  VoxelizeResult result;
  checkOutputs(job);
  result.holdsTriangles = inputsHoldTriangles(job);
  if (result.holdsTriangles)
    runTriangles(job, result, report, progress);
  else
    runTets(job, result, report, progress);
  return result;
}

} // namespace

VoxelizeResult run(const VoxelizeJob& job, Report& report, Progress& progress) {
  if (job.threads <= 0)
    return runHere(job, report, progress);
  tbb::task_arena arena(job.threads);
  return arena.execute([&] { return runHere(job, report, progress); });
}

} // namespace tetvdb
