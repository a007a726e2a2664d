// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/ShapeGrids.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/fields/CapFaces.h"
#include "tetvdb/fields/Coverage.h"
#include "tetvdb/fields/DistanceBand.h"
#include "tetvdb/fields/DistanceOnDevice.h"
#include "tetvdb/fields/FogVolume.h"
#include "tetvdb/fields/LevelSet.h"
#include "tetvdb/fields/ShapeSolid.h"
#include "tetvdb/fields/ShellSurface.h"
#include "tetvdb/fields/WholeBoxLevelSet.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/NanoGrids.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/BoundaryRaster.h"
#include "tetvdb/voxelize/RunOnDevice.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/SoupBoundary.h"
#include "tetvdb/voxelize/TreeBuilder.h"
#include "tetvdb/voxelize/TreeEstimate.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <utility>

namespace tetvdb {
namespace {

openvdb::BoolGrid::Ptr maskOf(const Voxelization& made) {
  for (const auto& grid : made.volume.grids().all)
    if (grid->getName() == "mask" && grid->isType<openvdb::BoolGrid>())
      return openvdb::gridPtrCast<openvdb::BoolGrid>(grid);
  throw Error(Status::Usage, "addShapeGrids()", "the volume has no grid 'mask'");
}

// A level set of a whole box needs no band, except to find closed holes.
double bandOf(const ShapeOptions& options) {
  constexpr double kUsual = 3;
  return options.halfWidth == kWholeBox ? kUsual : options.halfWidth;
}

// Checks the memory of all requested grids; for a whole box, of the preceding steps.
void requireTreeMemory(const ShapeSolid& solid, const ShapeOptions& options) {
  ShapeOptions banded = options;
  banded.halfWidth = bandOf(options);
  VoxelizeOptions limit;
  limit.maxMemory = options.maxMemory;
  requireMemory(shapeBytes(solid, banded), limit);
}

openvdb::FloatGrid::Ptr coverageOf(const ShapeSolid& solid, const GridTransform& transform,
                                   const ShapeOptions& options, ShapeSums& sums, StageTimer& timer,
                                   Report& report, Progress& progress) {
  DeviceQuestion question;
  question.cost = [&] {
    return estimateCoverageCost(estimateBandLeaves(solid.mesh, solid.faces, 0),
                                static_cast<double>(solid.faces.faces.size()));
  };
  openvdb::FloatGrid::Ptr grid = runOnDevice(
      options.device, question, sums.coverageDevice, report,
      [&](const auto& start) {
        timer.part("coverage");
        const CoverageFaces faces(solid.points, solid.faces, transform, progress);
        timer.part("start");
        const BorrowedDevices devices = start();
        timer.part("coverage");
        const nano::Result made = devices->coverage(faces.job(), progress);
        sums.coverage = made.counts.coverage;
        timer.part("tree");
        return openvdb::gridPtrCast<openvdb::FloatGrid>(gridOfNano(made.bytes));
      },
      [&] {
        timer.part("coverage");
        return coverage(solid.points, solid.faces, transform, sums.coverage, progress);
      });
  warnOfOverlap(sums.coverage, report);
  return grid;
}

openvdb::FloatGrid::Ptr surfaceOf(ShapeSolid& solid, const openvdb::BoolGrid::Ptr& inside,
                                  const GridTransform& transform, const ShapeOptions& options,
                                  DeviceUsed& used, StageTimer& timer, Report& report,
                                  Progress& progress) {
  bool capped = false;
  const auto make = [&](const BandRasterizer& rasterize) {
    timer.part("level set");
    const auto once = [&] {
      return levelSet(solid.mesh, solid.faces, *inside, transform, bandOf(options), solid.shell,
                      rasterize, progress);
    };
    if (options.halfWidth == kWholeBox) {
      if (solid.boundary)
        addCapFaces(*once(), inside, transform, *solid.boundary, solid.mesh, solid.faces, progress);
      const VoxelBox box = options.box.value_or(
          wholeBox(solid.mesh, solid.faces, inside->evalActiveVoxelBoundingBox(), solid.shell));
      VoxelizeOptions limit;
      limit.maxMemory = options.maxMemory;
      requireMemory(wholeBoxBytes(box, solid.faces.faces.size()), limit);
      return wholeBoxLevelSet(solid.mesh, solid.faces, *inside, transform, box, solid.shell,
                              progress);
    }
    openvdb::FloatGrid::Ptr grid = once();
    if (!solid.boundary || capped)
      return grid;
    capped = addCapFaces(*grid, inside, transform, *solid.boundary, solid.mesh, solid.faces,
                         progress) > 0;
    return capped ? once() : grid;
  };
  DeviceQuestion question;
  question.cost = [&] {
    return estimateBandCost(
        estimateBandLeaves(solid.mesh, solid.faces, bandOf(options) + solid.shell),
        static_cast<double>(solid.faces.faces.size()));
  };
  // Distances in a whole box are computed on the CPU.
  const DeviceChoice device =
      options.halfWidth == kWholeBox ? DeviceChoice{DeviceKind::Cpu, {0}} : options.device;
  return runOnDevice(
      device, question, used, report,
      [&](const auto& start) {
        timer.part("start");
        const BorrowedDevices devices = start();
        return make([&](const DistanceBand& band, const NodeTaker& take, Progress& seen) {
          rasterizeBandOn(*devices, band, take, seen);
        });
      },
      [&] { return make(rasterizeBand); });
}

openvdb::FloatGrid::Ptr sidedSurfaceOf(ShapeSolid& solid, const openvdb::BoolGrid::Ptr& inside,
                                       const GridTransform& transform, const ShapeOptions& options,
                                       DeviceUsed& used, StageTimer& timer, Report& report,
                                       Progress& progress) {
  const double size = transform.voxelSize[0];
  ShapeOptions wide = options;
  wide.halfWidth = options.halfWidth + solid.thickness;
  const openvdb::FloatGrid::Ptr distance =
      surfaceOf(solid, solid.filled, transform, wide, used, timer, report, progress);
  timer.part("side");
  openvdb::FloatGrid::Ptr grid = shellSurface(*distance, *inside, solid.thickness * size,
                                              solid.outward, options.halfWidth * size);
  grid->setTransform(makeTransform(transform));
  return grid;
}

ShapeSums add(ShapeSolid solid, const ShapeOptions& options, Voxelization& made, StageTimer& timer,
              Report& report, Progress& progress) {
  requireTreeMemory(solid, options);
  ShapeSums sums;
  openvdb::GridPtrVec& all = made.volume.grids().all;
  const openvdb::BoolGrid::Ptr inside = maskOf(made);
  // Before the level set adds faces where holes are closed.
  openvdb::FloatGrid::Ptr filled, surface;
  if (contains(options.grids, GridKind::Coverage)) {
    filled = coverageOf(solid, made.transform, options, sums, timer, report, progress);
  }
  if (contains(options.grids, GridKind::Surface) || contains(options.grids, GridKind::Fog)) {
    if (solid.filled) {
      surface = sidedSurfaceOf(solid, inside, made.transform, options, sums.device, timer, report,
                               progress);
    } else {
      if (solid.shell == 0) {
        timer.part("trim");
        trimShape(solid, sums.trim, report, progress);
      }
      surface =
          surfaceOf(solid, inside, made.transform, options, sums.device, timer, report, progress);
    }
  }
  for (const GridKind kind : options.grids) {
    if (kind != GridKind::Fog) {
      all.push_back(kind == GridKind::Coverage ? filled : surface);
      continue;
    }
    timer.part("fog");
    const bool both = contains(options.grids, GridKind::Surface);
    const openvdb::FloatGrid::Ptr fog = both ? surface->deepCopy() : surface;
    makeFog(*fog, fogDepth(*fog));
    fog->setTransform(makeTransform(made.transform)); // deepCopy() rounds it
    all.push_back(fog);
  }
  return sums;
}

} // namespace

void checkShapes(const ShapeOptions& options, const Vec3d& voxelSize) {
  if (options.halfWidth == kWholeBox) {
    if (contains(options.grids, GridKind::Fog))
      throw Error(Status::Usage, "`grid=fog`", "requires a number as half-width",
                  "give `half_width` a number, or make only 'surface'");
  } else if (!(options.halfWidth >= kMinHalfWidth && options.halfWidth <= kMaxHalfWidth)) {
    throw Error(Status::Usage, "`half_width`",
                fmt::format("{} voxels is not between {} and {}", options.halfWidth, kMinHalfWidth,
                            kMaxHalfWidth),
                "'all' includes every voxel of the mesh's box");
  }
  if (!options.grids.empty())
    checkGridKinds(options.grids, {GridMaker::Distance, GridMaker::Share});
  const bool cubes = voxelSize[0] == voxelSize[1] && voxelSize[1] == voxelSize[2];
  for (const GridKind kind : options.grids)
    if (infoOf(kind).needsCubes && !cubes)
      throw Error(Status::Usage, fmt::format("`grid={}`", infoOf(kind).name),
                  "requires cubic voxels: a level set has one voxel size",
                  "give `voxel_size` one number");
}

ShapeSums addShapeGrids(const TetMesh& mesh, const ShapeOptions& options, Voxelization& made,
                        Report& report, Progress& progress) {
  checkShapes(options, made.transform.voxelSize);
  checkMesh(mesh);
  progress.stage("fields");
  StageTimer timer(report, "fields");
  timer.part("boundary");
  return add(shapeSolid(mesh, made.transform, progress), options, made, timer, report, progress);
}

namespace {

// For a closed mesh: its enclosed voxels.
void fillForShell(ShapeSolid& solid, const TriangleMesh& mesh, const SolidOptions& how,
                  const ShapeOptions& options, const GridTransform& transform, Progress& progress) {
  const SoupBoundary boundary = soupBoundary(mesh, progress);
  if (!boundary.edges.empty())
    throw Error(Status::Invalid, "`grid=surface`",
                fmt::format("of a shell on one side requires closed faces; the mesh has {} open "
                            "edges",
                            boundary.edges.size()),
                "choose density or mask, or leave `shell_side` out");
  const double wide = options.halfWidth + how.shell / transform.voxelSize[0];
  if (wide > kMaxHalfWidth)
    throw Error(Status::Usage, "`shell`",
                fmt::format("the shell's thickness and the half-width are {:.4g} voxels together, "
                            "a level set has at most {}",
                            wide, kMaxHalfWidth),
                "use larger voxels");
  SolidOptions filled = how;
  filled.shell = 0;
  VoxelizeOptions same;
  same.voxelSize = transform.voxelSize;
  same.origin = transform.origin;
  same.grids = {GridKind::Mask};
  same.maxMemory = options.maxMemory;
  same.allowEmpty = true;
  Report told;
  solid.filled = maskOf(voxelize(mesh, filled, same, told, progress));
  solid.thickness = how.shell / transform.voxelSize[0];
  solid.outward = how.side == ShellSide::Outward;
}

} // namespace

ShapeSums addShapeGrids(const TriangleMesh& mesh, const SolidOptions& how,
                        const ShapeOptions& options, Voxelization& made, Report& report,
                        Progress& progress) {
  checkShapes(options, made.transform.voxelSize);
  checkMesh(mesh);
  progress.stage("fields");
  StageTimer timer(report, "fields");
  timer.part("boundary");
  ShapeSolid solid =
      shapeSolid(mesh, how, contains(options.grids, GridKind::Coverage), made.transform, progress);
  const bool onSide = how.shell > 0 && how.side != ShellSide::Both;
  if (onSide && !contains(options.grids, GridKind::Coverage))
    fillForShell(solid, mesh, how, options, made.transform, progress);
  else
    solid.shell = how.shell / 2 / made.transform.voxelSize[0];
  return add(std::move(solid), options, made, timer, report, progress);
}

} // namespace tetvdb
