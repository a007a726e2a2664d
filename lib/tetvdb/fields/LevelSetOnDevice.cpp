// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/LevelSetOnDevice.h"

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

// `solid`: of the mesh of `view`, not trimmed.
std::optional<NanoBytes> makeOn(const nano::MeshView& view, ShapeSolid& solid,
                                const GridTransform& transform, const ShapeOptions& options,
                                ShapeSums& sums, StageTimer& timer, Report& report,
                                Progress& progress) {
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
  if (trimmed)
    job.faces = facesViewOf(solid.mesh, solid.faces);
  DeviceQuestion question;
  question.cost = [] { return DeviceCost{1, 0}; }; // the device has made the mask
  return runOnDevice(
      options.device, question, sums.device, report,
      [&](const auto& start) -> std::optional<NanoBytes> {
        timer.part("start");
        const std::shared_ptr<const BorrowedDevices> devices(new BorrowedDevices(start()));
        timer.part("level set");
        const nano::Result made = (**devices).levelSet(view, job, progress);
        if (made.bytes == nullptr)
          throw std::logic_error("a mesh that closes is open on the device");
        return NanoBytes{{devices, made.bytes}, made.counts.bufferBytes, made.counts.insideVoxels};
      },
      [] { return std::optional<NanoBytes>(); });
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
  return makeOn(viewOf(mesh), solid, transform, options, sums, timer, report, progress);
}

std::optional<NanoBytes> levelSetOnDevice(const TriangleMesh& mesh, const SolidOptions& how,
                                          const GridTransform& transform,
                                          const ShapeOptions& options, ShapeSums& sums,
                                          Report& report, Progress& progress) {
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
  return makeOn(viewOf(mesh), solid, transform, options, sums, timer, report, progress);
}

} // namespace tetvdb
