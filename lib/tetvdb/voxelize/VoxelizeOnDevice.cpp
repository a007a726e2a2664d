// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include "nanovdb_kernels/DeviceVoxelizer.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/volume/NanoGrids.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/RunOnDevice.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <memory>
#include <string>
#include <tbb/task_arena.h>
#include <utility>

namespace tetvdb {
namespace {

bool needsOwners(GridKind kind) {
  return infoOf(kind).maker == GridMaker::Owner;
}

nano::Job jobFor(GridKind kind, const GridTransform& transform) {
  nano::Job job;
  for (std::size_t k = 0; k < 3; ++k) {
    job.voxelSize[k] = transform.voxelSize[k];
    job.origin[k] = transform.origin[k];
  }
  job.name = infoOf(kind).name;
  job.type = needsOwners(kind)        ? nano::GridType::Owner
             : kind == GridKind::Mask ? nano::GridType::Bool
                                      : nano::GridType::Fog;
  return job;
}

// Value of every tet; empty where it is the tet's number.
std::vector<std::int32_t> valuesOf(GridKind kind, const TetMesh& mesh) {
  std::vector<std::int32_t> values;
  if (kind == GridKind::TetId && !mesh.cellOfTet.empty())
    values.assign(mesh.cellOfTet.begin(), mesh.cellOfTet.end());
  if (kind == GridKind::Material) {
    values.resize(mesh.tetCount());
    if (!mesh.regions.empty())
      for (std::size_t t = 0; t < values.size(); ++t)
        values[t] = mesh.regions[mesh.cell(t)];
  }
  return values;
}

NanoBytes copyOf(const unsigned char* bytes, std::size_t size) {
  const auto release = [](unsigned char* p) { std::free(p); };
  NanoBytes copy{
      {static_cast<unsigned char*>(std::aligned_alloc(64, (size + 63) / 64 * 64)), release}, size};
  if (copy.data == nullptr)
    throw Error(Status::Limit, "", "the grid does not fit in memory");
  std::memcpy(copy.data.get(), bytes, size);
  return copy;
}

// Seconds, fitted to what `tetvdb_device_bench auto`, `fields` and `levelset` measure on an H200
// and its host (docs/benchmarks.md). Of the device: CUDA's start and the first memory; tets from
// pageable memory; a byte of the grid, of which the host's memory and OpenVDB's tree take nearly
// all.
constexpr double kDeviceStart = 0.42 + 0.05, kDevicePerTet = 2e-9, kDevicePerByte = 0.25e-9;
// A byte of the values that come down, where the host has no more to do with them.
constexpr double kDevicePerValueByte = 0.03e-9;
// Of the CPU: of a core. Leaves of values are bound by memory.
constexpr double kCpuStart = 2e-3, kCpuPerTet = 90e-9, kCpuPerOwnedTet = 450e-9;
constexpr double kCpuPerMaskLeaf = 2e-6, kCpuPerValueLeaf = 8.5e-6;
// Of sampling fields, a core's seconds a tet and a number of a voxel, beside its leaf of values;
// on the device making pinned memory, and tets and arrays from pageable memory.
constexpr double kCpuPerSampledTet = 280e-9, kCpuPerNumber = 2e-9;
constexpr double kSamplerStart = 0.04, kDevicePerSampledTet = 5e-9;
// Of a level set: making a leaf, and finding its distances, of which a face that is small takes as
// much as some leaves; on the device from the host's arrays.
constexpr double kCpuPerBandLeaf = 3e-6, kCpuPerLeafOfDistances = 2e-6;
constexpr double kCpuPerBandFace = 3e-6, kDevicePerBandFace = 5e-9;
// Threads beyond these gain half as much.
constexpr double kFullThreads = 16;

double threadsThatGain() {
  const double all = tbb::this_task_arena::max_concurrency();
  return all <= kFullThreads ? all : (all + kFullThreads) / 2;
}

// Of a body that fills half of its box.
struct LeafCounts {
  double surface, volume;
};
LeafCounts leavesOf(const TetMesh& mesh, const GridTransform& transform) {
  const WorldBox box = boxOfUsed(mesh.points, mesh.tets);
  double leaves[3];
  for (std::size_t k = 0; k < 3; ++k)
    leaves[k] = (box.max[k] - box.min[k]) / transform.voxelSize[k] / 8 + 1;
  return {leaves[0] * leaves[1] + leaves[1] * leaves[2] + leaves[2] * leaves[0],
          leaves[0] * leaves[1] * leaves[2] / 2};
}

} // namespace

DeviceCost estimateFieldCost(const TetMesh& mesh, const GridTransform& transform, double numbers) {
  const double leaves = leavesOf(mesh, transform).volume;
  const auto tets = static_cast<double>(mesh.tetCount());
  // The host makes the leaves either way.
  const double trees = leaves * numbers * kCpuPerValueLeaf / threadsThatGain();
  const double sampled = tets * kCpuPerSampledTet + leaves * 512 * numbers * kCpuPerNumber;
  return {kCpuStart + trees + sampled / threadsThatGain(),
          kDeviceStart + kSamplerStart + trees + tets * kDevicePerSampledTet +
              leaves * numbers * 2048 * kDevicePerValueByte};
}

DeviceCost estimateBandCost(double leaves, double faces) {
  // The host makes the leaves either way.
  const double trees = leaves * kCpuPerBandLeaf / threadsThatGain();
  const double found = faces * kCpuPerBandFace / threadsThatGain();
  return {kCpuStart + trees + found + leaves * kCpuPerLeafOfDistances / threadsThatGain(),
          kDeviceStart + kSamplerStart + trees + faces * kDevicePerBandFace +
              leaves * 2048 * kDevicePerValueByte};
}

DeviceCost estimateCost(const TetMesh& mesh, const GridTransform& transform,
                        const VoxelizeOptions& options) {
  const auto [surface, volume] = leavesOf(mesh, transform);
  const auto tets = static_cast<double>(mesh.tetCount());
  const double threads = threadsThatGain();
  DeviceCost cost{kCpuStart, kDeviceStart};
  for (const GridKind kind : options.grids) {
    const bool owners = needsOwners(kind), mask = kind == GridKind::Mask;
    const double count = owners ? std::min(volume, surface + 3 * tets) : surface;
    cost.cpu += (tets * (owners ? kCpuPerOwnedTet : kCpuPerTet) +
                 count * (mask ? kCpuPerMaskLeaf : kCpuPerValueLeaf)) /
                threads;
    // With their share of the lower nodes.
    cost.device += tets * kDevicePerTet + count * (mask ? 310 : 2300) * kDevicePerByte;
  }
  return cost;
}

namespace {

Voxelization voxelizeOn(DeviceSet& devices, const TetMesh& mesh, const VoxelizeOptions& options,
                        std::vector<NanoBytes>* nanoGrids, Report& report, Progress& progress) {
  Voxelization result;
  result.transform = chooseTransform(mesh, options);
  const auto timed = [&](const char* name, double seconds, Stage stage = {}) {
    stage.name = name;
    stage.seconds = seconds;
    stage.peakBytes = peakResidentBytes();
    report.stages.push_back(std::move(stage));
  };
  auto grids = std::make_shared<GridSet>();
  nano::Times sum;
  Stage parts;
  nano::Counts counts;
  StageTimer download(report, "download"); // written last
  for (const GridKind kind : options.grids) {
    progress.check();
    const std::vector<std::int32_t> values = valuesOf(kind, mesh);
    const nano::MeshView view{mesh.points[0].data(), mesh.points.size(), mesh.tets.data(),
                              mesh.tetCount(), values.empty() ? nullptr : values.data()};
    download.part(jobFor(kind, result.transform).name + " on the device");
    const nano::Result made = devices.run(view, jobFor(kind, result.transform), progress);
    download.part(jobFor(kind, result.transform).name);
    grids->all.push_back(gridOfNano(made.bytes));
    if (nanoGrids != nullptr)
      nanoGrids->push_back(copyOf(made.bytes, made.counts.bufferBytes));
    const nano::Times times = devices.times();
    sum.upload += times.upload;
    sum.build += times.build;
    for (const auto& [name, seconds] : times.parts)
      parts.parts.push_back({name, seconds});
    counts = made.counts;
  }
  timed("upload", sum.upload);
  timed("voxelize", sum.build, std::move(parts));
  result.volume = Volume(std::move(grids));
  result.counts.flipped = counts.flipped;
  result.counts.dropped = counts.dropped;
  result.counts.boundaryFaces = counts.boundaryFaces;
  result.path =
      counts.method == nano::Method::Boundary ? OccupancyPath::Boundary : OccupancyPath::Tets;
  return result;
}

} // namespace

void requireDevice(const DeviceChoice& choice) {
  if (choice.kind != DeviceKind::Cuda)
    return;
  std::string why;
  const std::vector<std::string> names = nano::listDevices(why);
  for (const int number : choice.numbers) {
    const std::string option = "`device=cuda:" + std::to_string(number) + "`";
    if (names.empty())
      throw Error(Status::Device, option, why, "use `device` auto or cpu");
    if (number < 0 || static_cast<std::size_t>(number) >= names.size())
      throw Error(Status::Device, option,
                  fmt::format("there {} {} device{}, numbered from 0",
                              names.size() == 1 ? "is" : "are", names.size(),
                              names.size() == 1 ? "" : "s"),
                  "name another one");
  }
}

bool takesDevice(const DeviceChoice& choice, const DeviceQuestion& question, DeviceUsed& used,
                 std::vector<std::string>& names, Report& report) {
  used = {};
  if (choice.kind == DeviceKind::Cpu)
    return false;
  if (!question.unable.empty()) {
    if (choice.kind == DeviceKind::Cuda)
      report.warn("device-unused", question.unable);
    used.why = question.unable;
    return false;
  }
  requireDevice(choice);
  std::string why;
  names = nano::listDevices(why);
  if (choice.kind == DeviceKind::Cuda)
    return true;
  if (names.empty()) {
    used.why = why;
    return false;
  }
  const DeviceCost cost = question.cost();
  const bool gains = cost.device <= cost.cpu;
  used.why = gains ? fmt::format("about {:.2f} s, {:.2f} s on the CPU", cost.device, cost.cpu)
                   : fmt::format("the job is small: about {:.2f} s, {:.2f} s with the GPU",
                                 cost.cpu, cost.device);
  return gains;
}

Voxelization voxelize(const TetMesh& mesh, const VoxelizeOptions& options,
                      const DeviceChoice& choice, DeviceUsed& used,
                      std::vector<NanoBytes>* nanoGrids, Report& report, Progress& progress) {
  used = {};
  const auto onCpu = [&] { return voxelize(mesh, options, report, progress); };
  if (options.grids.empty() || mesh.tets.empty())
    return onCpu(); // to be refused
  checkMesh(mesh);
  if (choice.kind == DeviceKind::Auto && options.path != OccupancyPath::Auto) {
    used.why = "a path was asked for";
    return onCpu();
  }
  DeviceQuestion question;
  if (options.rule != VoxelRule::Centre)
    question.unable = "`rule=any` and all are the CPU's";
  question.cost = [&] { return estimateCost(mesh, chooseTransform(mesh, options), options); };
  return runOnDevice(
      choice, question, used, report,
      [&](const auto& start) {
        progress.stage("voxelize");
        initializeOpenVDB();
        DeviceSet devices = start();
        Voxelization result = voxelizeOn(devices, mesh, options, nanoGrids, report, progress);
        reportOrigin(result.transform, options, report);
        reportTets(result.counts, mesh.tetCount(), report);
        requireVoxels(result, options);
        return result;
      },
      [&] {
        if (nanoGrids != nullptr)
          nanoGrids->clear();
        return onCpu();
      });
}

} // namespace tetvdb
