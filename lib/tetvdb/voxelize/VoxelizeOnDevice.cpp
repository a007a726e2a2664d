// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include "nanovdb_kernels/DeviceVoxelizer.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/volume/NanoGrids.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/KeepResolution.h"
#include "tetvdb/voxelize/OpenSoup.h"
#include "tetvdb/voxelize/RunOnDevice.h"
#include "tetvdb/voxelize/SolidFaces.h"
#include "tetvdb/voxelize/TreeEstimate.h"
#include "tetvdb/voxelize/ViewOfMesh.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <tbb/task_arena.h>
#include <utility>

namespace tetvdb {
namespace {

bool needsOwners(GridKind kind) {
  return infoOf(kind).maker == GridMaker::Owner;
}

nano::Job jobFor(GridKind kind, const GridTransform& transform, FillRule rule) {
  nano::Job job;
  job.rule = rule;
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

// Region of every tet.
std::vector<std::int32_t> regionsOf(const TetMesh& mesh) {
  std::vector<std::int32_t> regions(mesh.tetCount());
  if (!mesh.regions.empty())
    for (std::size_t t = 0; t < regions.size(); ++t)
      regions[t] = mesh.regions[mesh.cell(t)];
  return regions;
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
constexpr double kCpuPerTriangle = 700e-9;
constexpr double kCpuPerMaskLeaf = 2e-6, kCpuPerValueLeaf = 8.5e-6;
// Of sampling fields, a core's seconds a tet and a number of a voxel, beside its leaf of values;
// on the device making pinned memory, and tets and arrays from pageable memory.
constexpr double kCpuPerSampledTet = 280e-9, kCpuPerNumber = 2e-9;
constexpr double kSamplerStart = 0.04, kDevicePerSampledTet = 5e-9;
// Of a level set: making a leaf, and finding its distances, of which a face that is small takes as
// much as some leaves; on the device from the host's arrays.
constexpr double kCpuPerBandLeaf = 3e-6, kCpuPerLeafOfDistances = 2e-6;
constexpr double kCpuPerBandFace = 3e-6, kDevicePerBandFace = 5e-9;
// Of coverage: a leaf's pairs of a voxel and a face and of a face and its leaves, as
// fields/Coverage.h says what one takes (not fitted); on the device the sums that come down.
constexpr double kCpuPerCoveredLeaf = 100 * 100e-9, kCpuPerCoveringFace = 3 * 100e-9;
constexpr double kBytesOfCoveredLeaf = 8192;
// Threads beyond these gain half as much.
constexpr double kFullThreads = 16;

double threadsThatGain() {
  const double all = tbb::this_task_arena::max_concurrency();
  return all <= kFullThreads ? all : (all + kFullThreads) / 2;
}

// On the device, with its share of the lower nodes.
double bytesOfLeaf(GridKind kind) {
  return kind == GridKind::Mask ? 310 : 2300;
}

// Of a body that fills half of its box.
struct LeafCounts {
  double surface, volume;
};
LeafCounts leavesOf(const WorldBox& box, const GridTransform& transform) {
  double leaves[3];
  for (std::size_t k = 0; k < 3; ++k)
    leaves[k] = (box.max[k] - box.min[k]) / transform.voxelSize[k] / 8 + 1;
  return {leaves[0] * leaves[1] + leaves[1] * leaves[2] + leaves[2] * leaves[0],
          leaves[0] * leaves[1] * leaves[2] / 2};
}

} // namespace

DeviceCost estimateFieldCost(const TetMesh& mesh, const GridTransform& transform, double numbers) {
  const double leaves = leavesOf(boxOfUsed(mesh.points, mesh.tets), transform).volume;
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

DeviceCost estimateCoverageCost(double leaves, double faces) {
  // The host makes the leaves either way.
  const double trees = leaves * kCpuPerValueLeaf / threadsThatGain();
  return {kCpuStart + trees +
              (leaves * kCpuPerCoveredLeaf + faces * kCpuPerCoveringFace) / threadsThatGain(),
          kDeviceStart + kSamplerStart + trees + faces * kDevicePerBandFace +
              leaves * kBytesOfCoveredLeaf * kDevicePerValueByte};
}

DeviceCost estimateCost(const WorldBox& box, std::size_t tetCount, const GridTransform& transform,
                        const VoxelizeOptions& options) {
  const auto [surface, volume] = leavesOf(box, transform);
  const auto tets = static_cast<double>(tetCount);
  const double threads = threadsThatGain();
  DeviceCost cost{kCpuStart, kDeviceStart};
  for (const GridKind kind : options.grids) {
    const bool owners = needsOwners(kind), mask = kind == GridKind::Mask;
    const double count = owners ? std::min(volume, surface + 3 * tets) : surface;
    cost.cpu += (tets * (owners ? kCpuPerOwnedTet : kCpuPerTet) +
                 count * (mask ? kCpuPerMaskLeaf : kCpuPerValueLeaf)) /
                threads;
    cost.device += tets * kDevicePerTet + count * bytesOfLeaf(kind) * kDevicePerByte;
  }
  return cost;
}

DeviceCost estimateCost(const TriangleMesh& mesh, const GridTransform& transform,
                        const VoxelizeOptions& options) {
  const double surface = leavesOf(boxOfUsed(mesh.points, mesh.triangles), transform).surface;
  const auto triangles = static_cast<double>(mesh.triangleCount());
  DeviceCost cost{kCpuStart, kDeviceStart};
  for (const GridKind kind : options.grids) {
    cost.cpu += (triangles * kCpuPerTriangle +
                 surface * (kind == GridKind::Mask ? kCpuPerMaskLeaf : kCpuPerValueLeaf)) /
                threadsThatGain();
    cost.device += triangles * kDevicePerTet + surface * bytesOfLeaf(kind) * kDevicePerByte;
  }
  return cost;
}

namespace {

// What voxelizeOn() made.
struct MadeOnDevice {
  Voxelization result;
  bool closes = true; ///< false: nothing was made, since the mesh needs its holes filled
  std::uint64_t activeVoxels = 0; ///< of the first grid
};

// The grids of meshOf(kind), of world coordinates. `nanoGrids`, unless null, receives them in place
// of the volume if all have leaves.
template <typename MeshOf>
MadeOnDevice voxelizeOn(const std::shared_ptr<const BorrowedDevices>& borrowed,
                        const GridTransform& transform, const std::vector<GridKind>& kinds,
                        FillRule rule, const MeshOf& meshOf, std::vector<NanoBytes>* nanoGrids,
                        Report& report, Progress& progress) {
  DeviceSet& devices = **borrowed;
  MadeOnDevice all;
  Voxelization& result = all.result;
  result.transform = transform;
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
  for (const GridKind kind : kinds) {
    progress.check();
    const nano::Job job = jobFor(kind, transform, rule);
    download.part(job.name + " on the device");
    const nano::Result made = devices.run(meshOf(kind), job, progress);
    counts = made.counts;
    result.counts.openEdges = counts.openEdges;
    if (made.bytes == nullptr) {
      all.closes = false;
      return all;
    }
    download.part(job.name);
    if (kind == kinds.front())
      all.activeVoxels = describeNano(made.bytes).activeVoxels;
    if (nanoGrids != nullptr && counts.leaves == 0) { // tiles alone need one that is opened
      for (const NanoBytes& before : *nanoGrids)
        grids->all.push_back(gridOfNano(before.data.get()));
      nanoGrids->clear();
      nanoGrids = nullptr;
    }
    const NanoBytes there{{borrowed, made.bytes}, counts.bufferBytes, 0};
    if (nanoGrids == nullptr)
      grids->all.push_back(gridOfNano(made.bytes));
    else // no run follows the last one that needs its memory
      nanoGrids->push_back(kind == kinds.back() ? there : copyOf(there));
    const nano::Times times = devices.times();
    sum.upload += times.upload;
    sum.build += times.build;
    for (const auto& [name, seconds] : times.parts)
      parts.parts.push_back({name, seconds});
  }
  timed("upload", sum.upload);
  timed("voxelize", sum.build, std::move(parts));
  result.volume = Volume(std::move(grids));
  result.counts.flipped = counts.flipped;
  result.counts.dropped = counts.dropped;
  result.counts.boundaryFaces = counts.boundaryFaces;
  result.path = counts.method == nano::Method::Tets ? OccupancyPath::Tets : OccupancyPath::Boundary;
  return all;
}

// An open soup with all that the device needs of it.
struct FilledHoles {
  FilledHoles(const TriangleMesh& mesh, const SolidOptions& solid, const GridTransform& transform,
              StageTimer& timer, Progress& progress)
      : faces(solidFaces(mesh, solid, transform, timer, progress)) {
    timer.part("leaves");
    soup.emplace(*faces.holes, progress);
    view = soup->view();
  }

  SolidFaces faces;
  std::optional<OpenSoup> soup;
  nano::HolesView view;
};

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
  if (choice.kind == DeviceKind::Auto && nano::deviceSupport()) {
    const DeviceCost cost = question.cost();
    if (!cost.gains()) { // found before CUDA starts, which takes longer than such a job
      used.why = fmt::format("the job is small: about {:.2f} s, {:.2f} s with a GPU", cost.cpu,
                             cost.device);
      return false;
    }
    used.why = fmt::format("about {:.2f} s, {:.2f} s on the CPU", cost.device, cost.cpu);
  }
  requireDevice(choice);
  std::string why;
  names = nano::listDevices(why);
  if (names.empty())
    used.why = why;
  return choice.kind == DeviceKind::Cuda || !names.empty();
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
  question.cost = [&] {
    const WorldBox box = boxOfUsed(mesh.points, mesh.tets);
    return estimateCost(box, mesh.tetCount(), chooseTransform(box, options), options);
  };
  return runOnDevice(
      choice, question, used, report,
      [&](const auto& start) {
        progress.stage("voxelize");
        initializeOpenVDB();
        const std::shared_ptr<const BorrowedDevices> devices(new BorrowedDevices(start()));
        std::vector<std::int32_t> regions;
        const auto viewFor = [&](GridKind kind) {
          nano::MeshView view = viewOf(mesh);
          if (kind == GridKind::Material) {
            regions = regionsOf(mesh);
            view.values = regions.data();
          } else if (kind != GridKind::TetId) {
            view.values = nullptr;
          }
          return view;
        };
        MadeOnDevice made = voxelizeOn(devices, chooseTransform(mesh, options), options.grids,
                                       FillRule::Positive, viewFor, nanoGrids, report, progress);
        reportTransform(made.result.transform, options, report);
        reportTets(made.result.counts, mesh.tetCount(), report);
        requireVoxels(made.activeVoxels == 0, options);
        return std::move(made.result);
      },
      [&] {
        if (nanoGrids != nullptr)
          nanoGrids->clear();
        return onCpu();
      });
}

Voxelization voxelize(const TriangleMesh& mesh, const SolidOptions& solid,
                      const VoxelizeOptions& options, const DeviceChoice& choice, DeviceUsed& used,
                      std::vector<NanoBytes>* nanoGrids, Report& report, Progress& progress) {
  used = {};
  const auto onCpu = [&] {
    if (nanoGrids != nullptr)
      nanoGrids->clear();
    return voxelize(mesh, solid, options, report, progress);
  };
  if (choice.kind == DeviceKind::Cpu)
    return onCpu();
  checkSolidOptions(mesh, solid, options);
  checkMesh(mesh);
  const std::optional<FillRule> rule = fillRuleOf(solid);
  DeviceQuestion question;
  if (options.rule != VoxelRule::Centre)
    question.unable = "`rule=any` and all are the CPU's";
  else if (!rule)
    question.unable = "shells and `inside=flood` are the CPU's";
  question.cost = [&] {
    return estimateCost(mesh, chooseTransform(mesh, options, solid), options);
  };
  return runOnDevice(
      choice, question, used, report,
      [&](const auto& start) {
        progress.stage("voxelize");
        initializeOpenVDB();
        const std::shared_ptr<const BorrowedDevices> devices(new BorrowedDevices(start()));
        nano::MeshView view = viewOf(mesh);
        const auto voxelized = [&](const GridTransform& transform, std::vector<NanoBytes>* nano,
                                   Report& told) {
          MadeOnDevice made = voxelizeOn(
              devices, transform, options.grids, *rule, [&](GridKind) { return view; }, nano, told,
              progress);
          if (made.closes)
            reportTransform(made.result.transform, options, told);
          return made;
        };
        MadeOnDevice closed = voxelized(chooseTransform(mesh, options, solid), nanoGrids, report);
        if (closed.closes) {
          checkSolid(mesh, {}, solid, closed.activeVoxels, 0, options, report);
          return std::move(closed.result);
        }
        return keepResolution(options, report, [&](const VoxelizeOptions& now, Report& told) {
          const GridTransform transform = chooseTransform(mesh, now, solid);
          std::optional<FilledHoles> filled;
          {
            StageTimer timer(told, "holes");
            filled.emplace(mesh, solid, transform, timer, progress);
          }
          view.holes = &filled->view;
          // Trees, whose extent decides whether voxels have to be larger.
          MadeOnDevice made = voxelized(transform, nullptr, told);
          made.result.counts = filled->faces.counts;
          checkSolid(mesh, filled->faces.boundary, solid, made.activeVoxels,
                     estimateByBoundary(filled->faces.snapped, filled->faces.chain).leaves *
                         kLeafSize * kLeafSize,
                     now, told);
          return std::move(made.result);
        });
      },
      onCpu);
}

struct DeviceColumns::State {
  State(const nano::MeshView& seen, FillRule rule, const GridTransform& transform,
        const DeviceChoice& choice, DeviceUsed& used)
      : devices({DeviceKind::Cuda, {choice.numbers.front()}}, nano::listDevices(used.why),
                used.name),
        mesh(seen), job(jobFor(GridKind::Mask, transform, rule)) {
    mesh.values = nullptr;
    job.type = nano::GridType::Mask;
    job.oneColumn = true;
  }

  BorrowedDevices devices;
  nano::MeshView mesh;
  nano::Job job;
};

DeviceColumns::DeviceColumns(const TetMesh& mesh, const GridTransform& transform,
                             const DeviceChoice& choice, DeviceUsed& used)
    : state_(std::make_unique<State>(viewOf(mesh), FillRule::Positive, transform, choice, used)) {}
DeviceColumns::DeviceColumns(const TriangleMesh& mesh, FillRule rule,
                             const GridTransform& transform, const DeviceChoice& choice,
                             DeviceUsed& used)
    : state_(std::make_unique<State>(viewOf(mesh), rule, transform, choice, used)) {}
DeviceColumns::~DeviceColumns() = default;

const unsigned char* DeviceColumns::make(std::int32_t x, std::int32_t y, Progress& progress) {
  state_->job.column[0] = x;
  state_->job.column[1] = y;
  const nano::Result made = state_->devices->run(state_->mesh, state_->job, progress);
  if (made.bytes == nullptr)
    throw std::logic_error("triangles that close are open on the device");
  return made.bytes;
}

std::shared_ptr<nano::DeviceArray> insideOnDevice(const TriangleMesh& mesh,
                                                  const GridTransform& transform,
                                                  const VoxelBox& box, const DeviceChoice& choice,
                                                  Report& report, Progress& progress) {
  StageTimer timer(report, "voxelize");
  progress.stage("voxelize");
  requireDevice(choice);
  std::string why, name;
  const BorrowedDevices devices({DeviceKind::Cuda, {choice.numbers.front()}},
                                nano::listDevices(why), name);
  nano::Job job = jobFor(GridKind::Mask, transform, FillRule::Positive);
  job.type = nano::GridType::Mask;
  job.download = false;
  nano::MeshView view = viewOf(mesh);
  nano::Result made = devices->run(view, job, progress);
  std::optional<FilledHoles> filled;
  if (made.device == nullptr) {
    filled.emplace(mesh, SolidOptions(), transform, timer, progress);
    view.holes = &filled->view;
    made = devices->run(view, job, progress);
  }
  const nano::VoxelRange range = rangeOf(box);
  auto array = std::make_shared<nano::DeviceArray>(choice.numbers.front(), range.voxels());
  devices->single()->expand(made, job.type, range, *array);
  return array;
}

} // namespace tetvdb
