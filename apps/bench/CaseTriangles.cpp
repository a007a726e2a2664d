// SPDX-License-Identifier: Apache-2.0
//
// Triangles into a mask against openvdb::tools::meshToVolume, and triangle files: cases triangles
// and readtri.
#include "Cases.h"
#include "MeshToVolumePeer.h"
#include "TriangleMeshes.h"
#include "tetvdb/io/TriangleReader.h"
#include "tetvdb/io/TriangleWriter.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace tetvdb::bench {
namespace {

constexpr int kResolution = 1024;

/// bumpySphere() with six round holes, from a twentieth of a radian to four tenths.
TriangleMesh sphereWithHoles(double faces) {
  const TriangleMesh whole = bumpySphere(faces);
  const std::array<double, 6> cosines = {std::cos(0.05), std::cos(0.1), std::cos(0.15),
                                         std::cos(0.2),  std::cos(0.3), std::cos(0.4)};
  return meshes::without(whole, [&](std::size_t face) {
    Vec3d midpoint = {0, 0, 0};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        midpoint[axis] += whole.points[whole.triangles[3 * face + k]][axis];
    const double length = std::hypot(midpoint[0], midpoint[1], midpoint[2]);
    for (std::size_t hole = 0; hole < cosines.size(); ++hole)
      if ((hole % 2 == 0 ? 1 : -1) * midpoint[hole / 2] > cosines[hole] * length)
        return true;
    return false;
  });
}

/// "closed", "open" or a file's name; cleaned.
TriangleMesh meshNamed(const std::string& name, int shrink) {
  if (name == "closed")
    return bumpySphere(1e5 / shrink);
  if (name == "open")
    return sphereWithHoles(1e5 / shrink);
  Report report;
  Progress progress;
  TriangleMesh mesh = readTriangles(name, report, progress);
  cleanTriangles(mesh, {}, progress);
  return mesh;
}

VoxelizeOptions maskOptions(int resolution) {
  VoxelizeOptions options;
  options.grids = {GridKind::Mask};
  options.resolution = resolution;
  return options;
}

/// Seconds of stage `voxelize`; its parts and voxels go to `last`.
double timeMask(const TriangleMesh& mesh, int resolution, OursResult* last) {
  Report report;
  Progress progress;
  const Voxelization made =
      voxelize(mesh, SolidOptions(), maskOptions(resolution), report, progress);
  if (last != nullptr) {
    const GridInfo info = describe(made.volume).front();
    *last = {info.activeVoxels, info.bytes, made.path, report.stages.back().parts};
  }
  return report.stages.back().seconds;
}

/// What a child of this program uses at its peak for `work`, less what one uses that only has the
/// mesh.
struct Peaks {
  double ours = 0, peer = 0;
};

Peaks peaksOf(const std::string& mesh, int resolution, const Setup& setup) {
  const auto peak = [&](const char* work) {
    const ChildResult result = setup.launcher->run(
        {std::filesystem::canonical("/proc/self/exe").string(), "--child", work, mesh,
         std::to_string(resolution), std::to_string(setup.shrink), std::to_string(setup.threads)});
    if (result.status != 0)
      throw std::runtime_error(fmt::format("the child for {} ended with {}", work, result.status));
    return static_cast<double>(result.peakBytes);
  };
  const double empty = peak("nothing");
  return {peak("mask") - empty, peak("meshToVolume") - empty};
}

void compareSolid(const std::string& name, double target, const Setup& setup, Tables& tables) {
  const TriangleMesh mesh = meshNamed(name, setup.shrink);
  const int resolution =
      std::max(16, static_cast<int>(kResolution / std::sqrt(static_cast<double>(setup.shrink))));
  const GridTransform transform = chooseTransform(mesh, maskOptions(resolution));
  OursResult ours;
  std::size_t peerVoxels = 0;
  const std::vector<Times> times =
      interleave({{"ours", [&] { return timeMask(mesh, resolution, &ours); }},
                  {"meshToVolume",
                   [&] {
                     openvdb::FloatGrid::Ptr grid;
                     const double seconds =
                         secondsOf([&] { grid = meshToVolume(mesh, transform); });
                     peerVoxels = grid->activeVoxelCount();
                     return seconds;
                   }}},
                 setup.rounds(5), true);
  const Peaks peaks = peaksOf(name, resolution, setup);
  Row row;
  row.what = fmt::format("{}, {} triangles, {}^3", std::filesystem::path(name).filename().string(),
                         countName(static_cast<double>(mesh.triangleCount())), resolution);
  row.peerName = "meshToVolume";
  row.ours = times[0];
  row.peer = times[1];
  row.targetRatio = target;
  std::string parts;
  for (const StagePart& part : ours.parts)
    parts += fmt::format("{}{} {}", parts.empty() ? "" : ", ", part.name, duration(part.seconds));
  row.peakBytes = peaks.ours;
  row.peerPeakBytes = peaks.peer;
  row.targetLessBytes = setup.meshes.empty() ? 10 : 0;
  row.note =
      fmt::format("{}; {} voxels inside, {} in its band", parts, ours.activeVoxels, peerVoxels);
  tables.add(row);
}

/// The bytes into memory of their own.
double timePlainRead(const std::string& path) {
  return secondsOf([&] {
    const std::size_t size = std::filesystem::file_size(path);
    const std::unique_ptr<char[]> bytes(new char[size]);
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                               &std::fclose);
    if (!file || std::fread(bytes.get(), 1, size, file.get()) != size)
      throw std::runtime_error("cannot read " + path);
  });
}

} // namespace

void runTriangles(const Setup& setup, Tables& tables) {
  tables.begin(
      "triangles",
      "Stage `voxelize` of cleaned triangles with grid mask, box to finished tree, against "
      "the call of meshToVolume alone, float, half-width 3 (its level set; making a mask "
      "of that would come on top). Memory: peak of a process that does the one, less that "
      "of a process that only has the mesh.");
  if (setup.meshes.empty()) {
    compareSolid("closed", 20, setup, tables);
    compareSolid("open", 1, setup, tables);
  } else {
    for (const std::string& mesh : setup.meshes)
      compareSolid(mesh, 1, setup, tables);
  }
  tables.end();
}

void runReadTriangles(const Setup& setup, Tables& tables) {
  tables.begin("readtri", "readTriangles() on one thread, from files in the page cache, against "
                          "fread into new memory of the file's size. The target is 600 MB/s for "
                          "binary STL and 200 MB/s for OBJ.");
  struct Sample {
    const char* name;
    double faces;  ///< for about 200 MB
    double target; ///< bytes a second
  };
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  for (const Sample& sample : {Sample{"sphere.stl", 4e6, 600e6}, Sample{"sphere.obj", 3.8e6, 200e6},
                               Sample{"sphere.off", 3.8e6, 0}, Sample{"sphere.ply", 8e6, 0}}) {
    const std::string path = setup.folder + "/" + sample.name;
    const TriangleMesh mesh = bumpySphere(sample.faces / setup.shrink);
    {
      Progress progress;
      writeTriangles(path, mesh, progress);
    }
    const std::vector<Times> times = interleave(
        {{"ours",
          [&] {
            return secondsOf([&] {
              Report report;
              Progress progress;
              if (readTriangles(path, report, progress).triangleCount() != mesh.triangleCount())
                throw std::runtime_error(path + ": not all triangles were read");
            });
          }},
         {"fread into new memory", [&] { return timePlainRead(path); }}},
        setup.rounds(5), true);
    const auto bytes = static_cast<double>(std::filesystem::file_size(path));
    Row row;
    row.what = fmt::format("{} triangles, .{}",
                           countName(static_cast<double>(mesh.triangleCount())), sample.name + 7);
    row.peerName = "fread into new memory";
    row.ours = times[0];
    row.peer = times[1];
    row.targetSeconds = sample.target > 0 ? bytes / sample.target : 0;
    row.note = fmt::format("file {}, {:.0f} MB/s", size(bytes), bytes / times[0].median() * 1e-6);
    tables.add(row);
    std::filesystem::remove(path);
  }
  tables.end();
}

int trianglesChild(const std::vector<std::string>& words) {
  const std::string& work = words.at(0);
  const int resolution = std::stoi(words.at(2));
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(std::stoi(words.at(4))));
  openvdb::initialize();
  const TriangleMesh mesh = meshNamed(words.at(1), std::stoi(words.at(3)));
  if (work == "mask")
    timeMask(mesh, resolution, nullptr);
  else if (work == "meshToVolume")
    meshToVolume(mesh, chooseTransform(mesh, maskOptions(resolution)));
  return 0;
}

} // namespace tetvdb::bench
