// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/FillHoles.h"
#include "tetvdb/geometry/TriangleClusters.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/BoundaryRaster.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/FloodRaster.h"
#include "tetvdb/voxelize/KeepResolution.h"
#include "tetvdb/voxelize/MaskRaster.h"
#include "tetvdb/voxelize/RuleSink.h"
#include "tetvdb/voxelize/ShellRaster.h"
#include "tetvdb/voxelize/ShellSide.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/SolidFaces.h"
#include "tetvdb/voxelize/SoupBoundary.h"
#include "tetvdb/voxelize/SoupChain.h"
#include "tetvdb/voxelize/TreeBuilder.h"
#include "tetvdb/voxelize/TreeEstimate.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <optional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

// How far a shell reaches beyond the faces, world units.
double reachOf(const TriangleMesh& mesh, const SolidOptions& solid) {
  if (solid.side == ShellSide::Both)
    return solid.shell / 2;
  if (solid.side == ShellSide::Outward)
    return solid.shell;
  Progress progress;
  const bool closed = soupBoundary(mesh, progress).edges.empty();
  return closed ? 0 : solid.shell * (1 + 1e-5); // so that both ends lie within the box
}

openvdb::BoolGrid::Ptr maskOf(const GridTransform& transform,
                              const std::function<void(NodeSink&)>& rasterize) {
  TreeBuilder builder({GridKind::Mask}, TetMesh());
  rasterize(builder);
  return openvdb::gridPtrCast<openvdb::BoolGrid>(builder.finish(transform).front());
}

// The voxels of a shell that lies on one side of the faces.
openvdb::BoolGrid::Ptr shellOnSide(const TriangleMesh& mesh, const SolidOptions& solid,
                                   const SnappedMesh& snapped, const Boundary& chain,
                                   const SoupBoundary& boundary, const GridTransform& transform,
                                   Progress& progress) {
  const openvdb::BoolGrid::Ptr shell = maskOf(transform, [&](NodeSink& sink) {
    rasterizeShell(snapped, chain, transform.voxelSize, solid.shell, sink, progress);
  });
  const bool outward = solid.side == ShellSide::Outward;
  if (!boundary.edges.empty()) {
    keepSide(shell->tree(), mesh, snapped, transform.voxelSize, solid.shell, outward, progress);
    return shell;
  }
  SolidOptions filled = solid;
  filled.shell = 0;
  const openvdb::BoolGrid::Ptr inside = maskOf(transform, [&](NodeSink& sink) {
    FillOptions fill;
    fill.rule = fillRuleOf(filled).value_or(FillRule::Positive);
    rasterizeBoundary(snapped, chain, fill, sink, progress);
  });
  if (outward)
    shell->topologyDifference(*inside);
  else
    shell->topologyIntersection(*inside);
  return shell;
}

} // namespace

std::optional<FillRule> fillRuleOf(const SolidOptions& solid) {
  if (solid.shell > 0)
    return std::nullopt;
  switch (solid.inside) {
  case InsideRule::Winding:
    return FillRule::Positive;
  case InsideRule::NonZero:
    return FillRule::NonZero;
  case InsideRule::Parity:
    return FillRule::Odd;
  default:
    return std::nullopt;
  }
}

WorldBox boxOf(const TriangleMesh& mesh, const SolidOptions& solid) {
  WorldBox box = boxOfUsed(mesh.points, mesh.triangles);
  if (solid.shell > 0)
    box.grow(reachOf(mesh, solid));
  return box;
}

GridTransform chooseTransform(const TriangleMesh& mesh, const VoxelizeOptions& options,
                              const SolidOptions& solid) {
  if (mesh.triangles.empty())
    throw Error(Status::Invalid, "", "the mesh has no triangles");
  return chooseTransform(boxOf(mesh, solid), options, solid);
}

GridTransform chooseTransform(const WorldBox& box, const VoxelizeOptions& options,
                              const SolidOptions& solid) {
  // What is inward lies within the box.
  const bool bothIn = solid.shell > 0 && solid.side != ShellSide::Inward;
  return chooseTransform(box, options, bothIn ? BoxEnds::BothIn : BoxEnds::OneIn);
}

namespace {

Voxelization voxelizeOnce(const TriangleMesh& mesh, const SolidOptions& solid,
                          const VoxelizeOptions& options, Report& report, Progress& progress) {
  StageTimer timer(report, "voxelize");
  Voxelization result;
  result.path = OccupancyPath::Boundary;
  timer.part("transform");
  result.transform = chooseTransform(mesh, options, solid);
  reportTransform(result.transform, options, report);
  const SolidFaces faces = solidFaces(mesh, solid, result.transform, timer, progress);
  const SnappedMesh& snapped = faces.snapped;
  const Boundary& chain = faces.chain;
  const SoupBoundary& boundary = faces.boundary;
  result.counts = faces.counts;
  const bool onSide = solid.shell > 0 && solid.side != ShellSide::Both;
  const bool flood = solid.inside == InsideRule::Flood;

  timer.part("estimate");
  double working = bytesOf(faces);
  if (flood) // columns of cells, with a margin of nodes
    working += 96.0 * ((snapped.boxMax.x - snapped.boxMin.x) * kVoxelsPerUnit + 3 * kNodeSize) *
               ((snapped.boxMax.y - snapped.boxMin.y) * kVoxelsPerUnit + 3 * kNodeSize);
  TreeEstimate estimate = estimateByBoundary(snapped, chain);
  const double surfaceVoxels = estimate.leaves * kLeafSize * kLeafSize;
  if (solid.shell > 0) {
    const auto leaves = static_cast<double>(estimateShellLeaves(
        snapped, chain, result.transform.voxelSize, onSide ? solid.shell : solid.shell / 2));
    estimate = {leaves, leaves / 128 + 64};
  }
  const double bytes = working + estimate.bytes(options.grids);
  result.estimatedBytes = static_cast<std::size_t>(bytes);
  requireMemory(bytes, options);

  timer.part("rasterize");
  TreeBuilder builder(options.grids, TetMesh());
  if (onSide) {
    rasterizeMasks({shellOnSide(mesh, solid, snapped, chain, boundary, result.transform, progress)},
                   builder, progress);
  } else if (solid.shell > 0) {
    rasterizeShell(snapped, chain, result.transform.voxelSize, solid.shell / 2, builder, progress);
  } else if (flood) {
    rasterizeFlood(snapped, chain, TriangleScene(mesh), result.transform, builder, progress);
  } else {
    const FillOptions fill = faces.fill();
    if (options.rule == VoxelRule::Centre) {
      rasterizeBoundary(snapped, chain, fill, builder, progress);
    } else {
      const RuledFaces ruled(snapped, chain, progress);
      RuleSink sink(builder, ruled, options.rule, 0, ruled.size());
      rasterizeBoundary(snapped, chain, fill, sink, progress);
      sink.finish();
    }
  }
  timer.part("tree");
  auto grids = std::make_shared<GridSet>();
  grids->all = builder.finish(result.transform);
  result.volume = Volume(std::move(grids));

  const openvdb::GridBase& first = *result.volume.grids().all.front();
  checkSolid(mesh, boundary, solid, first.activeVoxelCount(), surfaceVoxels, options, report);
  return result;
}

} // namespace

Voxelization voxelize(const TriangleMesh& mesh, const SolidOptions& solid,
                      const VoxelizeOptions& options, Report& report, Progress& progress) {
  progress.stage("voxelize");
  checkSolidOptions(mesh, solid, options);
  checkMesh(mesh);
  initializeOpenVDB();
  return keepResolution(options, report, [&](const VoxelizeOptions& used, Report& told) {
    return voxelizeOnce(mesh, solid, used, told, progress);
  });
}

} // namespace tetvdb
