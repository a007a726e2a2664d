// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/ShapesOnDevice.h"

#include "nanovdb_kernels/DeviceArray.h"
#include "tetvdb/fields/Coverage.h"
#include "tetvdb/fields/DistanceOnDevice.h"
#include "tetvdb/fields/ShapeSolid.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/volume/NanoGrids.h"
#include "tetvdb/voxelize/RunOnDevice.h"
#include "tetvdb/voxelize/TreeEstimate.h"
#include "tetvdb/voxelize/ViewOfMesh.h"

#include <memory>
#include <optional>
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

// What the device makes grids of.
struct DeviceShape {
  Devices devices;
  nano::MeshView mesh;
  nano::LevelSetJob levelSet;             // with the faces that trimming has left, if it took some
  const CoverageFaces* covered = nullptr; // where coverage is asked for
};

// use(shape, timer); none where the CPU has to make the grids.
template <typename Mesh, typename MakeSolid, typename Use>
auto makeOn(const Mesh& mesh, const MakeSolid& makeSolid, const GridTransform& transform,
            const ShapeOptions& options, ShapeSums& sums, Report& report, Progress& progress,
            const Use& use) -> decltype(use(DeviceShape(), std::declval<StageTimer&>())) {
  using Made = decltype(use(DeviceShape(), std::declval<StageTimer&>()));
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
  DeviceShape shape;
  Boundary untrimmed;
  std::optional<CoverageFaces> covered;
  const bool covers = contains(options.grids, GridKind::Coverage);
  const bool measures =
      contains(options.grids, GridKind::Surface) || contains(options.grids, GridKind::Fog);
  if (covers) {
    timer.part("coverage");
    untrimmed = solid.faces;
    shape.covered = &covered.emplace(solid.points, untrimmed, transform, progress);
  }
  bool trimmed = false;
  if (measures) {
    timer.part("trim");
    trimmed = trimShape(solid, sums.trim, report, progress);
  }
  shape.levelSet = levelSetJobFor(transform, options.halfWidth);
  shape.levelSet.rule = *solid.rule;
  if (trimmed)
    shape.levelSet.faces = facesViewOf(solid.mesh, solid.faces);
  shape.mesh = viewOf(mesh);
  DeviceQuestion question;
  question.cost = [] { return DeviceCost{1, 0}; }; // where it is asked for, a device is in use
  DeviceUsed used;
  Made made = runOnDevice(
      options.device, question, used, report,
      [&](const auto& start) {
        timer.part("start");
        shape.devices = Devices(new BorrowedDevices(start()));
        return use(shape, timer);
      },
      [] { return Made(); });
  if (measures)
    sums.device = used;
  if (covers)
    sums.coverageDevice = used;
  return made;
}

// The grids of options.grids, one after the other.
auto gridsOf(const ShapeOptions& options, ShapeSums& sums, Report& report, Progress& progress) {
  return [&](const DeviceShape& shape, StageTimer& timer) {
    std::vector<NanoBytes> grids;
    for (const GridKind kind : options.grids) {
      if (!grids.empty()) // it is in memory that the device is about to use again
        grids.back() = copyOf(grids.back());
      const bool covers = kind == GridKind::Coverage;
      timer.part(covers ? "coverage" : "level set");
      nano::LevelSetJob levelSet = shape.levelSet;
      levelSet.fog = kind == GridKind::Fog;
      levelSet.name = infoOf(kind).name;
      const nano::Result made = covers ? (**shape.devices).coverage(shape.covered->job(), progress)
                                       : levelSetBy(shape.devices, shape.mesh, levelSet, progress);
      if (covers) {
        if (made.counts.rootTiles + made.counts.upperNodes == 0)
          return std::vector<NanoBytes>();
        sums.coverage = made.counts.coverage;
      }
      grids.push_back(
          {{shape.devices, made.bytes}, made.counts.bufferBytes, made.counts.insideVoxels});
    }
    warnOfOverlap(sums.coverage, report);
    return grids;
  };
}

} // namespace

std::vector<NanoBytes> shapesOnDevice(const TetMesh& mesh, const GridTransform& transform,
                                      const ShapeOptions& options, ShapeSums& sums, Report& report,
                                      Progress& progress) {
  return makeOn(
      mesh, [&] { return shapeSolid(mesh, transform, progress); }, transform, options, sums, report,
      progress, gridsOf(options, sums, report, progress));
}

std::vector<NanoBytes> shapesOnDevice(const TriangleMesh& mesh, const SolidOptions& how,
                                      const GridTransform& transform, const ShapeOptions& options,
                                      ShapeSums& sums, Report& report, Progress& progress) {
  if (how.shell > 0)
    return {};
  const bool covers = contains(options.grids, GridKind::Coverage);
  return makeOn(
      mesh, [&] { return shapeSolid(mesh, how, covers, transform, progress); }, transform, options,
      sums, report, progress, gridsOf(options, sums, report, progress));
}

std::shared_ptr<nano::DeviceArray>
distancesOnDevice(const TriangleMesh& mesh, const GridTransform& transform, const VoxelBox& box,
                  const ShapeOptions& options, Report& report, Progress& progress) {
  ShapeSums sums;
  const auto expand = [&](const DeviceShape& shape, StageTimer& timer) {
    timer.part("level set");
    nano::LevelSetJob job = shape.levelSet;
    job.download = false;
    const nano::Result made = levelSetBy(shape.devices, shape.mesh, job, progress);
    std::shared_ptr<nano::DeviceArray> array;
    if (made.counts.insideVoxels == 0)
      return array;
    const nano::VoxelRange range = rangeOf(box);
    array = std::make_shared<nano::DeviceArray>(options.device.numbers.front(),
                                                range.voxels() * sizeof(float));
    (*shape.devices)->single()->expandValues(made, range, *array);
    return array;
  };
  return makeOn(
      mesh, [&] { return shapeSolid(mesh, SolidOptions(), false, transform, progress); }, transform,
      options, sums, report, progress, expand);
}

} // namespace tetvdb
