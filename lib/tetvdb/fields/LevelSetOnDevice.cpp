// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/LevelSetOnDevice.h"

#include "nanovdb_kernels/DeviceArray.h"
#include "tetvdb/fields/DistanceOnDevice.h"
#include "tetvdb/fields/ShapeSolid.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/voxelize/RunOnDevice.h"
#include "tetvdb/voxelize/TreeEstimate.h"
#include "tetvdb/voxelize/ViewOfMesh.h"

#include <memory>
#include <stdexcept>
#include <utility>

namespace tetvdb {
namespace {

// use(devices, result) with the level set of the mesh of `view`, whose faces, not trimmed, are
// those of `solid`.
template <typename Use>
auto makeOn(const nano::MeshView& view, ShapeSolid& solid, const GridTransform& transform,
            const ShapeOptions& options, ShapeSums& sums, StageTimer& timer, Report& report,
            Progress& progress, bool downloads, const Use& use) {
  VoxelizeOptions limit;
  limit.maxMemory = options.maxMemory;
  requireMemory(shapeBytes(solid, options), limit);
  timer.part("trim");
  const bool trimmed = trimShape(solid, sums.trim, report, progress);
  nano::LevelSetJob job;
  job.rule = *solid.rule;
  job.voxelSize = transform.voxelSize[0];
  for (std::size_t k = 0; k < 3; ++k)
    job.origin[k] = transform.origin[k];
  job.halfWidth = options.halfWidth;
  job.name = infoOf(GridKind::Surface).name;
  job.download = downloads;
  if (trimmed)
    job.faces = facesViewOf(solid.mesh, solid.faces);
  DeviceQuestion question;
  question.cost = [] { return DeviceCost{1, 0}; }; // where it is asked for, a device is in use
  using Devices = std::shared_ptr<const BorrowedDevices>;
  using Used = decltype(use(Devices(), nano::Result()));
  return runOnDevice(
      options.device, question, sums.device, report,
      [&](const auto& start) {
        timer.part("start");
        const Devices devices(new BorrowedDevices(start()));
        timer.part("level set");
        const nano::Result made = (**devices).levelSet(view, job, progress);
        if (made.bytes == nullptr && made.device == nullptr)
          throw std::logic_error("a mesh that closes is open on the device");
        return use(devices, made);
      },
      [] { return Used(); });
}

std::optional<NanoBytes> withBytes(const std::shared_ptr<const BorrowedDevices>& devices,
                                   const nano::Result& made) {
  return NanoBytes{{devices, made.bytes}, made.counts.bufferBytes, made.counts.insideVoxels};
}

} // namespace

std::optional<NanoBytes> levelSetOnDevice(const TetMesh& mesh, const GridTransform& transform,
                                          const ShapeOptions& options, ShapeSums& sums,
                                          Report& report, Progress& progress) {
  if (options.halfWidth == kWholeBox)
    return {};
  checkShapes(options, transform.voxelSize);
  checkMesh(mesh);
  progress.stage("fields");
  StageTimer timer(report, "fields");
  timer.part("boundary");
  ShapeSolid solid = shapeSolid(mesh, transform, progress);
  return makeOn(viewOf(mesh), solid, transform, options, sums, timer, report, progress, true,
                withBytes);
}

namespace {

template <typename Use>
auto makeOn(const TriangleMesh& mesh, const SolidOptions& how, const GridTransform& transform,
            const ShapeOptions& options, ShapeSums& sums, Report& report, Progress& progress,
            bool downloads, const Use& use)
    -> decltype(use(std::shared_ptr<const BorrowedDevices>(), nano::Result())) {
  if (options.halfWidth == kWholeBox || how.shell > 0)
    return {};
  checkShapes(options, transform.voxelSize);
  checkMesh(mesh);
  progress.stage("fields");
  StageTimer timer(report, "fields");
  timer.part("boundary");
  ShapeSolid solid = shapeSolid(mesh, how, false, transform, progress);
  if (!solid.rule)
    return {};
  return makeOn(viewOf(mesh), solid, transform, options, sums, timer, report, progress, downloads,
                use);
}

} // namespace

std::optional<NanoBytes> levelSetOnDevice(const TriangleMesh& mesh, const SolidOptions& how,
                                          const GridTransform& transform,
                                          const ShapeOptions& options, ShapeSums& sums,
                                          Report& report, Progress& progress) {
  return makeOn(mesh, how, transform, options, sums, report, progress, true, withBytes);
}

std::shared_ptr<nano::DeviceArray>
distancesOnDevice(const TriangleMesh& mesh, const GridTransform& transform, const VoxelBox& box,
                  const ShapeOptions& options, Report& report, Progress& progress) {
  ShapeSums sums;
  return makeOn(mesh, SolidOptions(), transform, options, sums, report, progress, false,
                [&](const std::shared_ptr<const BorrowedDevices>& devices,
                    const nano::Result& made) -> std::shared_ptr<nano::DeviceArray> {
                  if (made.counts.insideVoxels == 0)
                    return nullptr;
                  const nano::VoxelRange range = rangeOf(box);
                  auto array = std::make_shared<nano::DeviceArray>(options.device.numbers.front(),
                                                                   range.voxels() * sizeof(float));
                  (*devices)->single()->expandValues(made, range, *array);
                  return array;
                });
}

} // namespace tetvdb
