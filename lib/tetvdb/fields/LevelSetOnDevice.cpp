// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/LevelSetOnDevice.h"

#include "nanovdb_kernels/DeviceArray.h"
#include "tetvdb/fields/DistanceOnDevice.h"
#include "tetvdb/fields/ShapeSolid.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/volume/NanoGrids.h"
#include "tetvdb/voxelize/RunOnDevice.h"
#include "tetvdb/voxelize/TreeEstimate.h"
#include "tetvdb/voxelize/ViewOfMesh.h"

#include <memory>
#include <stdexcept>
#include <utility>

namespace tetvdb {
namespace {

using Devices = std::shared_ptr<const BorrowedDevices>;

nano::Result levelSetBy(const Devices& devices, const nano::MeshView& mesh,
                        const nano::LevelSetJob& job, Progress& progress) {
  const nano::Result made = (**devices).levelSet(mesh, job, progress);
  if (made.bytes == nullptr && made.device == nullptr)
    throw std::logic_error("a mesh that closes is open on the device");
  return made;
}

// use(devices, mesh, job) with the job of the level set of a mesh whose faces, not trimmed, are
// those of makeSolid(); none where the CPU has to make it.
template <typename Mesh, typename MakeSolid, typename Use>
auto makeOn(const Mesh& mesh, const MakeSolid& makeSolid, const GridTransform& transform,
            const ShapeOptions& options, ShapeSums& sums, Report& report, Progress& progress,
            const Use& use) -> decltype(use(Devices(), nano::MeshView(), nano::LevelSetJob())) {
  using Made = decltype(use(Devices(), nano::MeshView(), nano::LevelSetJob()));
  if (options.halfWidth == kWholeBox)
    return {};
  checkShapes(options, transform.voxelSize);
  checkMesh(mesh);
  progress.stage("fields");
  StageTimer timer(report, "fields");
  timer.part("boundary");
  ShapeSolid solid = makeSolid();
  if (!solid.rule)
    return {};
  VoxelizeOptions limit;
  limit.maxMemory = options.maxMemory;
  requireMemory(shapeBytes(solid, options), limit);
  timer.part("trim");
  const bool trimmed = trimShape(solid, sums.trim, report, progress);
  nano::LevelSetJob job = levelSetJobFor(transform, options.halfWidth);
  job.rule = *solid.rule;
  if (trimmed)
    job.faces = facesViewOf(solid.mesh, solid.faces);
  DeviceQuestion question;
  question.cost = [] { return DeviceCost{1, 0}; }; // where it is asked for, a device is in use
  return runOnDevice(
      options.device, question, sums.device, report,
      [&](const auto& start) {
        timer.part("start");
        const Devices devices(new BorrowedDevices(start()));
        timer.part("level set");
        return use(devices, viewOf(mesh), job);
      },
      [] { return Made(); });
}

// The grids of `kinds`, one after the other.
auto gridsOf(const std::vector<GridKind>& kinds, Progress& progress) {
  return [&](const Devices& devices, const nano::MeshView& mesh, nano::LevelSetJob job) {
    std::vector<NanoBytes> grids;
    for (const GridKind kind : kinds) {
      if (!grids.empty()) // it is in memory that the device is about to use again
        grids.back() = copyOf(grids.back());
      job.fog = kind == GridKind::Fog;
      job.name = infoOf(kind).name;
      const nano::Result made = levelSetBy(devices, mesh, job, progress);
      grids.push_back({{devices, made.bytes}, made.counts.bufferBytes, made.counts.insideVoxels});
    }
    return grids;
  };
}

} // namespace

std::vector<NanoBytes> levelSetsOnDevice(const TetMesh& mesh, const GridTransform& transform,
                                         const ShapeOptions& options, ShapeSums& sums,
                                         Report& report, Progress& progress) {
  return makeOn(
      mesh, [&] { return shapeSolid(mesh, transform, progress); }, transform, options, sums, report,
      progress, gridsOf(options.grids, progress));
}

std::vector<NanoBytes> levelSetsOnDevice(const TriangleMesh& mesh, const SolidOptions& how,
                                         const GridTransform& transform,
                                         const ShapeOptions& options, ShapeSums& sums,
                                         Report& report, Progress& progress) {
  if (how.shell > 0)
    return {};
  return makeOn(
      mesh, [&] { return shapeSolid(mesh, how, false, transform, progress); }, transform, options,
      sums, report, progress, gridsOf(options.grids, progress));
}

std::shared_ptr<nano::DeviceArray>
distancesOnDevice(const TriangleMesh& mesh, const GridTransform& transform, const VoxelBox& box,
                  const ShapeOptions& options, Report& report, Progress& progress) {
  ShapeSums sums;
  const auto expand = [&](const Devices& devices, const nano::MeshView& view,
                          nano::LevelSetJob job) {
    job.download = false;
    const nano::Result made = levelSetBy(devices, view, job, progress);
    std::shared_ptr<nano::DeviceArray> array;
    if (made.counts.insideVoxels == 0)
      return array;
    const nano::VoxelRange range = rangeOf(box);
    array = std::make_shared<nano::DeviceArray>(options.device.numbers.front(),
                                                range.voxels() * sizeof(float));
    (*devices)->single()->expandValues(made, range, *array);
    return array;
  };
  return makeOn(
      mesh, [&] { return shapeSolid(mesh, SolidOptions(), false, transform, progress); }, transform,
      options, sums, report, progress, expand);
}

} // namespace tetvdb
