// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/ReadInput.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/FinishCells.h"
#include "tetvdb/io/TriangleReader.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/source/Source.h"

#include <filesystem>

namespace tetvdb {
namespace {

// Adds the file's name to an error about one input.
Error withPath(const Error& error, const std::string& path) {
  std::string text = error.what();
  if (text.find(path) != std::string::npos)
    return error;
  if (text.rfind("mesh: ", 0) == 0)
    text.erase(0, 6);
  return {error.status(), path, text};
}

// Adds the file's name to every warning from number `first` on.
void nameFile(const std::string& path, std::size_t first, Report& report) {
  for (std::size_t i = first; i < report.warnings.size(); ++i)
    if (report.warnings[i].text.find(path) == std::string::npos)
      report.warnings[i].text = path + ": " + report.warnings[i].text;
}

[[noreturn]] void refuseKind(const std::string& name, const char* what) {
  throw Error(Status::Usage, name, std::string("holds no ") + what);
}

CellMesh cellsOf(const std::string& path, const ReadOptions& options, Report& report,
                 Progress& progress, FileFormat& format, const MemoryInputs& memory) {
  const MemoryInput* input = inMemory(path, memory);
  if (input == nullptr)
    return readCells(path, options, report, progress, &format);
  if (!input->cells)
    refuseKind(path, "solid cells");
  CellMesh cells = input->cells();
  finishCells(path, cells, options);
  return cells;
}

TriangleMesh trianglesOf(const std::string& path, Report& report, Progress& progress,
                         FileFormat& format, const MemoryInputs& memory) {
  const MemoryInput* input = inMemory(path, memory);
  if (input == nullptr)
    return readTriangles(path, report, progress, &format);
  if (!input->triangles)
    refuseKind(path, "triangles");
  return input->triangles();
}

} // namespace

void warnOfNaN(const Volume& volume, const std::string& path, Report& report) {
  if (volume.notNumbers > 0)
    report.warn("not-numbers", path + ": " + std::to_string(volume.notNumbers) +
                                   " voxels are not numbers (NaN) and become inactive");
}

void warnOfReading(const Volume& volume, const std::string& path, Report& report) {
  warnOfNaN(volume, path, report);
  for (const UnreadGrid& grid : volume.unread)
    report.warn("unread-grid", path + ": the grid '" + grid.name + "' is of type " + grid.type +
                                   ", which is not read");
}

Volume readVolumeInput(const std::string& path, Report& report, Progress& progress,
                       const MemoryInputs& memory) {
  const MemoryInput* input = inMemory(path, memory);
  if (input == nullptr) {
    Volume volume = readVolume(path, progress);
    warnOfReading(volume, path, report);
    return volume;
  }
  if (!input->volume)
    refuseKind(path, "grids");
  return *input->volume;
}

std::vector<std::string> filesAmong(const std::vector<std::string>& inputs,
                                    const MemoryInputs& memory) {
  std::vector<std::string> files;
  for (const std::string& input : inputs)
    if (inMemory(input, memory) == nullptr)
      files.push_back(input);
  return files;
}

void turnUp(std::vector<Vec3d>& points, UpAxis up) {
  if (up == UpAxis::Z)
    return;
  for (Vec3d& p : points)
    p = {p[0], p[2], -p[1]};
}

bool holdsTriangles(const std::string& path, const MemoryInputs& memory) {
  if (const MemoryInput* input = inMemory(path, memory))
    return static_cast<bool>(input->triangles);
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored) &&
      !std::filesystem::is_directory(path, ignored))
    return false; // a pipe can be read only once
  const MappedFile file(path);
  Progress progress;
  return holdsTriangles(file.source(), progress);
}

TetMesh readTets(const std::string& path, const ReadOptions& options, const CellFilter& filter,
                 InputInfo* info, Report& report, Progress& progress,
                 const MemoryInputs& memory) try {
  const std::size_t warningsBefore = report.warnings.size();
  FileFormat format = FileFormat::Unknown;
  CellMesh cells = cellsOf(path, options, report, progress, format, memory);
  if (info != nullptr) {
    info->path = path;
    info->format = format;
    info->vertices = cells.points.size();
    for (const CellRun& run : cells.runs)
      info->cells[run.fileType] += run.count;
    info->times = cells.times;
    if (!info->times.empty())
      info->step = options.timeStep < 0 ? info->times.size() - 1
                                        : static_cast<std::size_t>(options.timeStep);
  }
  progress.check();
  TetMesh mesh = splitCells(std::move(cells), filter, report, progress);
  nameFile(path, warningsBefore, report);
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

TriangleMesh readSoup(const std::string& path, InputInfo* info, Report& report, Progress& progress,
                      const MemoryInputs& memory) try {
  const std::size_t warningsBefore = report.warnings.size();
  FileFormat format = FileFormat::Unknown;
  TriangleMesh mesh = trianglesOf(path, report, progress, format, memory);
  nameFile(path, warningsBefore, report);
  if (info != nullptr) {
    info->path = path;
    info->format = format;
    info->vertices = mesh.points.size();
    info->triangles = mesh.triangleCount();
    info->units = mesh.units;
  }
  return mesh;
} catch (const Error& error) {
  if (error.status() == Status::Cancelled)
    throw;
  throw withPath(error, path);
}

} // namespace tetvdb
