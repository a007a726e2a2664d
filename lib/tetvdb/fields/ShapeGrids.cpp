// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/ShapeGrids.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/fields/CapFaces.h"
#include "tetvdb/fields/DistanceBand.h"
#include "tetvdb/fields/LevelSet.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
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
  return grid == ShapeGrid::Surface ? "surface" : "fog";
}

openvdb::BoolGrid::Ptr maskOf(const Voxelization& made) {
  for (const auto& grid : made.volume.grids().all)
    if (grid->getName() == "mask" && grid->isType<openvdb::BoolGrid>())
      return openvdb::gridPtrCast<openvdb::BoolGrid>(grid);
  throw Error(Status::Usage, "addShapeGrids()", "the volume has no grid 'mask'");
}

// The faces of a solid and what is known of it.
struct Solid {
  SnappedMesh mesh;
  Boundary faces;
  std::optional<RimWinding> rim; // of an open soup
  double shell = 0;              // half its thickness, voxels
};

void requireBandMemory(const Solid& solid, const ShapeOptions& options) {
  const double leaves =
      estimateBandLeaves(solid.mesh, solid.faces, options.halfWidth + solid.shell);
  const double trees = static_cast<double>(options.grids.size());
  const double bytes = 24.0 * static_cast<double>(solid.mesh.pointCount) +
                       40.0 * static_cast<double>(solid.faces.faces.size()) +
                       trees * (leaves * static_cast<double>(leafBytes(GridKind::Density)) +
                                (leaves / 128 + 64) * static_cast<double>(kLowerNodeBytes));
  VoxelizeOptions limit;
  limit.maxMemory = options.maxMemory;
  requireMemory(bytes, limit);
}

openvdb::FloatGrid::Ptr surfaceOf(Solid& solid, const openvdb::BoolGrid::Ptr& inside,
                                  const GridTransform& transform, const ShapeOptions& options,
                                  Progress& progress) {
  const auto make = [&] {
    return levelSet(solid.mesh, solid.faces, *inside, transform, options.halfWidth, solid.shell,
                    progress);
  };
  openvdb::FloatGrid::Ptr grid = make();
  if (solid.rim &&
      addCapFaces(*grid, inside, transform, *solid.rim, solid.mesh, solid.faces, progress) > 0)
    grid = make();
  return grid;
}

void add(Solid solid, const ShapeOptions& options, Voxelization& made, StageTimer& timer,
         Progress& progress) {
  requireBandMemory(solid, options);
  timer.part("level set");
  const openvdb::FloatGrid::Ptr surface =
      surfaceOf(solid, maskOf(made), made.transform, options, progress);
  openvdb::GridPtrVec& all = made.volume.grids().all;
  for (const ShapeGrid kind : options.grids) {
    if (kind == ShapeGrid::Surface) {
      all.push_back(surface);
      continue;
    }
    timer.part("fog");
    const bool last = options.grids.size() == 1;
    const openvdb::FloatGrid::Ptr fog = last ? surface : surface->deepCopy();
    openvdb::tools::sdfToFogVolume(*fog);
    fog->setName("fog");
    fog->setTransform(makeTransform(made.transform)); // deepCopy() rounds it
    all.push_back(fog);
  }
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
    if (voxelSize[0] != voxelSize[1] || voxelSize[1] != voxelSize[2])
      throw Error(Status::Usage, fmt::format("--grid {}", nameOf(kind)),
                  "needs voxels that are cubes: a level set has one voxel size",
                  "give --voxel-size one number");
  }
}

void addShapeGrids(const TetMesh& mesh, const ShapeOptions& options, Voxelization& made,
                   Report& report, Progress& progress) {
  checkShapes(options, made.transform.voxelSize);
  progress.stage("fields");
  StageTimer timer(report, "fields");
  timer.part("boundary");
  Solid solid;
  solid.mesh = snapMesh(mesh, made.transform, progress);
  solid.faces = boundaryFaces(solid.mesh, progress);
  add(std::move(solid), options, made, timer, progress);
}

void addShapeGrids(const TriangleMesh& mesh, const SolidOptions& how, const ShapeOptions& options,
                   Voxelization& made, Report& report, Progress& progress) {
  checkShapes(options, made.transform.voxelSize);
  progress.stage("fields");
  StageTimer timer(report, "fields");
  timer.part("boundary");
  Solid solid;
  solid.mesh = snapPoints(mesh.points, made.transform, progress);
  solid.faces = soupFaces(mesh, solid.mesh);
  solid.shell = how.shell / 2 / made.transform.voxelSize[0];
  const bool byWinding = how.method == SolidMethod::Winding && how.shell == 0 &&
                         (how.inside == InsideRule::Winding || how.inside == InsideRule::NonZero);
  if (byWinding || how.method == SolidMethod::Centroid) {
    const SoupRim rim = soupRim(mesh.triangles, progress);
    if (how.method == SolidMethod::Centroid)
      closeToCentre(rim.edges, solid.mesh, solid.faces);
    else if (!rim.edges.empty())
      solid.rim.emplace(windingOfRim(rim.edges, solid.mesh));
  }
  add(std::move(solid), options, made, timer, progress);
}

} // namespace tetvdb
