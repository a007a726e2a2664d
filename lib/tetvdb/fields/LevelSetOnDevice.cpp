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

using Devices = std::shared_ptr<const BorrowedDevices>;

// use(devices, result) with the level set of a mesh whose faces, not trimmed, are those of
// makeSolid(); none where the CPU has to make it.
template <typename Mesh, typename MakeSolid, typename Use>
auto makeOn(const Mesh& mesh, const MakeSolid& makeSolid, const GridTransform& transform,
            const ShapeOptions& options, ShapeSums& sums, Report& report, Progress& progress,
            bool downloads, const Use& use) -> decltype(use(Devices(), nano::Result())) {
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
  job.name = infoOf(GridKind::Surface).name;
  job.download = downloads;
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
        const nano::Result made = (**devices).levelSet(viewOf(mesh), job, progress);
        if (made.bytes == nullptr && made.device == nullptr)
          throw std::logic_error("a mesh that closes is open on the device");
        return use(devices, made);
      },
      [] { return decltype(use(Devices(), nano::Result()))(); });
}

std::optional<NanoBytes> withBytes(const Devices& devices, const nano::Result& made) {
  return NanoBytes{{devices, made.bytes}, made.counts.bufferBytes, made.counts.insideVoxels};
}

} // namespace

std::optional<NanoBytes> levelSetOnDevice(const TetMesh& mesh, const GridTransform& transform,
                                          const ShapeOptions& options, ShapeSums& sums,
                                          Report& report, Progress& progress) {
  return makeOn(
      mesh, [&] { return shapeSolid(mesh, transform, progress); }, transform, options, sums, report,
      progress, true, withBytes);
}

std::optional<NanoBytes> levelSetOnDevice(const TriangleMesh& mesh, const SolidOptions& how,
                                          const GridTransform& transform,
                                          const ShapeOptions& options, ShapeSums& sums,
                                          Report& report, Progress& progress) {
  if (how.shell > 0)
    return {};
  return makeOn(
      mesh, [&] { return shapeSolid(mesh, how, false, transform, progress); }, transform, options,
      sums, report, progress, true, withBytes);
}

std::shared_ptr<nano::DeviceArray>
distancesOnDevice(const TriangleMesh& mesh, const GridTransform& transform, const VoxelBox& box,
                  const ShapeOptions& options, Report& report, Progress& progress) {
  ShapeSums sums;
  const auto expand = [&](const Devices& devices, const nano::Result& made) {
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
      options, sums, report, progress, false, expand);
}

} // namespace tetvdb
