// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/ShapeGrids.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/fields/CapFaces.h"
#include "tetvdb/fields/Coverage.h"
#include "tetvdb/fields/DistanceBand.h"
#include "tetvdb/fields/DistanceOnDevice.h"
#include "tetvdb/fields/LevelSet.h"
#include "tetvdb/fields/TrimFaces.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/BoundaryRaster.h"
#include "tetvdb/voxelize/RunOnDevice.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/SoupChain.h"
#include "tetvdb/voxelize/SoupRim.h"
#include "tetvdb/voxelize/TreeBuilder.h"
#include "tetvdb/voxelize/TreeEstimate.h"

#include <algorithm>
#include <fmt/format.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <optional>
#include <utility>

namespace tetvdb {
namespace {

const char* nameOf(ShapeGrid grid) {
  constexpr const char* kNames[] = {"surface", "fog", "coverage"};
  return kNames[static_cast<std::size_t>(grid)];
}

openvdb::BoolGrid::Ptr maskOf(const Voxelization& made) {
  for (const auto& grid : made.volume.grids().all)
    if (grid->getName() == "mask" && grid->isType<openvdb::BoolGrid>())
      return openvdb::gridPtrCast<openvdb::BoolGrid>(grid);
  throw Error(Status::Usage, "addShapeGrids()", "the volume has no grid 'mask'");
}

bool asksFor(const ShapeOptions& options, ShapeGrid kind) {
  return std::find(options.grids.begin(), options.grids.end(), kind) != options.grids.end();
}

// The faces of a solid and what is known of it.
struct Solid {
  const std::vector<Vec3d>& points;
  SnappedMesh mesh; // the same points, snapped
  Boundary faces;
  std::optional<RimWinding> rim; // of an open soup
  double shell = 0;              // half its thickness, voxels
  std::optional<FillRule> rule;  // where faces close and windings say what is inside
};

// For all grids that are asked for.
void requireTreeMemory(const Solid& solid, const ShapeOptions& options) {
  const bool covers = asksFor(options, ShapeGrid::Coverage);
  const auto bands = static_cast<double>(options.grids.size()) - (covers ? 1 : 0);
  double leaves = covers ? static_cast<double>(estimateBoundaryLeaves(solid.mesh, solid.faces)) : 0;
  const double trimming = bands > 0 && solid.shell == 0 ? 200 : 0; // bytes a face
  if (bands > 0)
    leaves += bands * estimateBandLeaves(solid.mesh, solid.faces, options.halfWidth + solid.shell);
  const double bytes = 48.0 * static_cast<double>(solid.mesh.pointCount) +
                       (40.0 + trimming) * static_cast<double>(solid.faces.faces.size()) +
                       leaves * static_cast<double>(leafBytes(GridKind::Density)) +
                       (leaves / 128 + 64) * static_cast<double>(kLowerNodeBytes);
  VoxelizeOptions limit;
  limit.maxMemory = options.maxMemory;
  requireMemory(bytes, limit);
}

openvdb::FloatGrid::Ptr coverageOf(const Solid& solid, const GridTransform& transform,
                                   CoverageSum& sum, Report& report, Progress& progress) {
  openvdb::FloatGrid::Ptr grid = coverage(solid.points, solid.faces, transform, sum, progress);
  if (sum.overlapVoxels > 0)
    report.warn("overlap", fmt::format("parts of the mesh overlap: {} voxels are filled more than "
                                       "once, by {:.6g} voxels' volume that is counted once",
                                       sum.overlapVoxels, sum.overlap));
  return grid;
}

// Leaves those parts of the faces that are the solid's boundary.
void trim(Solid& solid, TrimCounts& counts, Report& report, Progress& progress) {
  constexpr const char* kAllFaces =
      "the level set's magnitudes are distances to all faces, those inside of the solid included";
  if (!solid.rule) {
    counts.met = countMetFaces(solid.mesh, solid.faces, progress);
    if (counts.met > 0)
      report.warn(
          "untrimmed",
          fmt::format("{} faces cross or touch others, and can only be cut along each other "
                      "in a mesh without open edges whose inside is not found by flood: {}",
                      counts.met, kAllFaces));
    return;
  }
  TrimmedFaces trimmed = trimFaces(solid.mesh, solid.faces, *solid.rule, progress);
  counts = trimmed.counts;
  if (!trimmed.complete)
    report.warn("untrimmed",
                fmt::format("too many faces cross to be cut along each other: {}", kAllFaces));
  if (!trimmed.changed)
    return;
  solid.mesh = std::move(trimmed.mesh);
  solid.faces = std::move(trimmed.faces);
}

openvdb::FloatGrid::Ptr surfaceOf(Solid& solid, const openvdb::BoolGrid::Ptr& inside,
                                  const GridTransform& transform, const ShapeOptions& options,
                                  DeviceUsed& used, StageTimer& timer, Report& report,
                                  Progress& progress) {
  bool capped = false;
  const auto make = [&](const BandRasterizer& rasterize) {
    timer.part("level set");
    const auto once = [&] {
      return levelSet(solid.mesh, solid.faces, *inside, transform, options.halfWidth, solid.shell,
                      rasterize, progress);
    };
    openvdb::FloatGrid::Ptr grid = once();
    if (!solid.rim || capped)
      return grid;
    capped =
        addCapFaces(*grid, inside, transform, *solid.rim, solid.mesh, solid.faces, progress) > 0;
    return capped ? once() : grid;
  };
  DeviceQuestion question;
  question.cost = [&] {
    return estimateBandCost(
        estimateBandLeaves(solid.mesh, solid.faces, options.halfWidth + solid.shell),
        static_cast<double>(solid.faces.faces.size()));
  };
  return runOnDevice(
      options.device, question, used, report,
      [&](const auto& start) {
        timer.part("start");
        DeviceSet devices = start();
        return make([&](const DistanceBand& band, const NodeTaker& take, Progress& seen) {
          rasterizeBandOn(devices, band, take, seen);
        });
      },
      [&] { return make(rasterizeBand); });
}

ShapeSums add(Solid solid, const ShapeOptions& options, Voxelization& made, StageTimer& timer,
              Report& report, Progress& progress) {
  requireTreeMemory(solid, options);
  ShapeSums sums;
  openvdb::GridPtrVec& all = made.volume.grids().all;
  const openvdb::BoolGrid::Ptr inside = maskOf(made);
  // Before the level set adds faces where holes are closed.
  openvdb::FloatGrid::Ptr filled, surface;
  if (asksFor(options, ShapeGrid::Coverage)) {
    timer.part("coverage");
    filled = coverageOf(solid, made.transform, sums.coverage, report, progress);
  }
  if (asksFor(options, ShapeGrid::Surface) || asksFor(options, ShapeGrid::Fog)) {
    if (solid.shell == 0) {
      timer.part("trim");
      trim(solid, sums.trim, report, progress);
    }
    surface =
        surfaceOf(solid, inside, made.transform, options, sums.device, timer, report, progress);
  }
  for (const ShapeGrid kind : options.grids) {
    if (kind != ShapeGrid::Fog) {
      all.push_back(kind == ShapeGrid::Coverage ? filled : surface);
      continue;
    }
    timer.part("fog");
    const bool both = asksFor(options, ShapeGrid::Surface);
    const openvdb::FloatGrid::Ptr fog = both ? surface->deepCopy() : surface;
    openvdb::tools::sdfToFogVolume(*fog);
    fog->setName("fog");
    fog->setTransform(makeTransform(made.transform)); // deepCopy() rounds it
    all.push_back(fog);
  }
  return sums;
}

void requireCoverable(const SolidOptions& how, const SoupRim& rim) {
  if (how.shell > 0 || how.method != SolidMethod::Winding || how.inside != InsideRule::Winding)
    throw Error(Status::Usage, "--grid coverage",
                "is found from the winding number alone: not with --shell, --inside or centroid",
                "leave them out");
  if (!rim.edges.empty())
    throw Error(Status::Invalid, "--grid coverage",
                fmt::format("needs faces that close; the mesh has {} open edges", rim.edges.size()),
                "use --mesher envelope, which closes holes by tets, or repair the mesh first");
}

} // namespace

void checkShapes(const ShapeOptions& options, const Vec3d& voxelSize) {
  if (!(options.halfWidth >= kMinHalfWidth && options.halfWidth <= kMaxHalfWidth))
    throw Error(Status::Usage, "--half-width",
                fmt::format("{} voxels is not between {} and {}", options.halfWidth, kMinHalfWidth,
                            kMaxHalfWidth));
  for (std::size_t i = 0; i < options.grids.size(); ++i) {
    const ShapeGrid kind = options.grids[i];
    if (std::find(options.grids.begin(), options.grids.begin() + static_cast<std::ptrdiff_t>(i),
                  kind) != options.grids.begin() + static_cast<std::ptrdiff_t>(i))
      throw Error(Status::Usage, "--grid", fmt::format("'{}' is asked for twice", nameOf(kind)),
                  "name every grid once");
    const bool cubes = voxelSize[0] == voxelSize[1] && voxelSize[1] == voxelSize[2];
    if (kind != ShapeGrid::Coverage && !cubes)
      throw Error(Status::Usage, fmt::format("--grid {}", nameOf(kind)),
                  "needs voxels that are cubes: a level set has one voxel size",
                  "give --voxel-size one number");
  }
}

ShapeSums addShapeGrids(const TetMesh& mesh, const ShapeOptions& options, Voxelization& made,
                        Report& report, Progress& progress) {
  checkShapes(options, made.transform.voxelSize);
  progress.stage("fields");
  StageTimer timer(report, "fields");
  timer.part("boundary");
  Solid solid{mesh.points, snapMesh(mesh, made.transform, progress), {}, {}, 0, {}};
  solid.faces = boundaryFaces(solid.mesh, progress);
  solid.rule = FillRule::Positive;
  return add(std::move(solid), options, made, timer, report, progress);
}

ShapeSums addShapeGrids(const TriangleMesh& mesh, const SolidOptions& how,
                        const ShapeOptions& options, Voxelization& made, Report& report,
                        Progress& progress) {
  checkShapes(options, made.transform.voxelSize);
  progress.stage("fields");
  StageTimer timer(report, "fields");
  timer.part("boundary");
  Solid solid{mesh.points, snapPoints(mesh.points, made.transform, progress), {}, {}, 0, {}};
  solid.faces = soupFaces(mesh, solid.mesh);
  solid.shell = how.shell / 2 / made.transform.voxelSize[0];
  const bool byWinding = how.method == SolidMethod::Winding && how.shell == 0 &&
                         (how.inside == InsideRule::Winding || how.inside == InsideRule::NonZero);
  const bool covers = asksFor(options, ShapeGrid::Coverage);
  solid.rule = fillRuleOf(how);
  if (byWinding || covers || how.method == SolidMethod::Centroid) {
    const SoupRim rim = soupRim(mesh.triangles, progress);
    if (covers)
      requireCoverable(how, rim);
    if (how.method == SolidMethod::Centroid)
      closeToCentre(rim.edges, solid.mesh, solid.faces);
    else if (!rim.edges.empty()) {
      solid.rim.emplace(windingOfRim(rim.edges, solid.mesh));
      solid.rule.reset();
    }
  }
  return add(std::move(solid), options, made, timer, report, progress);
}

} // namespace tetvdb
