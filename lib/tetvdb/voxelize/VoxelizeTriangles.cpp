// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/RimWinding.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/BoundaryRaster.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/FloodRaster.h"
#include "tetvdb/voxelize/RuleSink.h"
#include "tetvdb/voxelize/ShellRaster.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/SoupChain.h"
#include "tetvdb/voxelize/SoupRim.h"
#include "tetvdb/voxelize/TreeBuilder.h"
#include "tetvdb/voxelize/TreeEstimate.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

void checkOptions(const TriangleMesh& mesh, const SolidOptions& solid,
                  const VoxelizeOptions& options) {
  if (options.grids.empty())
    throw Error(Status::Usage, "--grid", "no grid was asked for");
  for (const GridKind kind : options.grids)
    if (kind == GridKind::TetId || kind == GridKind::Material)
      throw Error(Status::Usage, "--grid",
                  "tet_id and material need tetrahedra, the input is triangles",
                  "ask for density or mask");
  if (options.rule != VoxelRule::Centre &&
      (solid.shell > 0 || solid.method != SolidMethod::Winding ||
       solid.inside == InsideRule::Flood))
    throw Error(Status::Usage, "--rule",
                "any and all do not go with --shell, --inside flood or the centroid covering",
                "leave one of them out");
  if (!(solid.shell >= 0) || !std::isfinite(solid.shell))
    throw Error(Status::Usage, "--shell", fmt::format("{} is not a thickness", solid.shell));
  if (mesh.triangleCount() >= 0xFFFFFFFFu)
    throw Error(Status::Limit, "", "the mesh has 2^32 triangles or more", "split it in parts");
  if (mesh.triangles.empty())
    throw Error(Status::Invalid, "", "the mesh has no triangles");
}

std::string whyEmpty(const SoupRim& rim, const SolidOptions& solid) {
  if (solid.shell > 0)
    return "no voxel centre lies in the shell";
  if (rim.edges.empty())
    return "no voxel centre lies inside the mesh";
  if (solid.inside == InsideRule::Flood)
    return "the outside reaches every voxel: the mesh leaks at this voxel size";
  return fmt::format("the mesh is open ({} open edges) and holds no inside: its winding number is "
                     "above 0.5 at no voxel centre",
                     rim.edges.size());
}

// An open mesh whose inside is next to nothing beside its faces is rather a sheet.
void warnIfThin(std::uint64_t inside, double surface, Report& report) {
  if (static_cast<double>(inside) < 0.02 * surface)
    report.warn("nearly-empty",
                fmt::format("only {} voxels are inside faces that pass through about {:.0f}: the "
                            "mesh is rather a sheet, which --shell T gives a thickness",
                            inside, surface));
}

std::string emptyAdvice(const SoupRim& rim, const SolidOptions& solid) {
  if (solid.shell > 0 || rim.edges.empty())
    return "use smaller voxels, or --allow-empty to write an empty grid";
  if (solid.inside == InsideRule::Flood)
    return "use --inside winding, which closes holes, or larger voxels";
  return "give the sheet a thickness with --shell T, or use smaller voxels";
}

} // namespace

std::optional<FillRule> fillRuleOf(const SolidOptions& solid) {
  if (solid.shell > 0)
    return std::nullopt;
  if (solid.method == SolidMethod::Centroid)
    return FillRule::Odd;
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

GridTransform chooseTransform(const TriangleMesh& mesh, const VoxelizeOptions& options,
                              double shell) {
  if (mesh.triangles.empty())
    throw Error(Status::Invalid, "", "the mesh has no triangles");
  WorldBox box = boxOfUsed(mesh.points, mesh.triangles);
  for (std::size_t k = 0; k < 3; ++k) {
    box.min[k] -= shell / 2;
    box.max[k] += shell / 2;
  }
  return chooseTransform(box, options);
}

Voxelization voxelize(const TriangleMesh& mesh, const SolidOptions& solid,
                      const VoxelizeOptions& options, Report& report, Progress& progress) {
  progress.stage("voxelize");
  checkOptions(mesh, solid, options);
  initializeOpenVDB();

  StageTimer timer(report, "voxelize");
  Voxelization result;
  result.path = OccupancyPath::Boundary;
  timer.part("transform");
  result.transform = chooseTransform(mesh, options, solid.shell);
  reportOrigin(result.transform, options, report);
  timer.part("snap");
  SnappedMesh snapped = snapPoints(mesh.points, result.transform, progress);
  Boundary chain = soupFaces(mesh, snapped);
  result.counts.boundaryFaces = chain.faces.size();

  SoupRim rim;
  if (solid.shell == 0) {
    timer.part("rim");
    rim = soupRim(mesh.triangles, progress);
    result.counts.openEdges = rim.edges.size();
  }
  const bool flood = solid.method == SolidMethod::Winding && solid.inside == InsideRule::Flood;
  const FillRule rule = fillRuleOf(solid).value_or(FillRule::Positive);
  std::optional<RimWinding> winding;
  if (solid.method == SolidMethod::Centroid)
    closeToCentre(rim.edges, snapped, chain);
  else if (rule == FillRule::Odd && rim.oddEdges > 0)
    throw Error(Status::Invalid, "",
                fmt::format("{} edges have an odd number of faces, so that parity has no meaning",
                            rim.oddEdges),
                "use --inside winding, which closes holes");
  else if (!flood && rule != FillRule::Odd && !rim.edges.empty())
    winding.emplace(windingOfRim(rim.edges, snapped));
  if (winding && winding->rough())
    report.warn("rough-winding",
                fmt::format("the faces do not close at {} edges: their winding number is found to "
                            "about {} only",
                            rim.edges.size(), kRoughWindingError));

  timer.part("estimate");
  double working = 24.0 * static_cast<double>(snapped.pointCount) +
                   64.0 * static_cast<double>(chain.faces.size());
  if (flood) // columns of cells, with a margin of nodes
    working += 96.0 * ((snapped.boxMax.x - snapped.boxMin.x) * kVoxelsPerUnit + 3 * kNodeSize) *
               ((snapped.boxMax.y - snapped.boxMin.y) * kVoxelsPerUnit + 3 * kNodeSize);
  TreeEstimate estimate = estimateByBoundary(snapped, chain);
  const double surfaceVoxels = estimate.leaves * kLeafSize * kLeafSize;
  if (solid.shell > 0) {
    const auto leaves = static_cast<double>(
        estimateShellLeaves(snapped, chain, result.transform.voxelSize, solid.shell / 2));
    estimate = {leaves, leaves / 128 + 64};
  }
  const double bytes = working + estimate.bytes(options.grids);
  result.estimatedBytes = static_cast<std::size_t>(bytes);
  requireMemory(bytes, options);

  timer.part("rasterize");
  TreeBuilder builder(options.grids, TetMesh());
  if (solid.shell > 0) {
    rasterizeShell(snapped, chain, result.transform.voxelSize, solid.shell / 2, builder, progress);
  } else if (flood) {
    rasterizeFlood(snapped, chain, TriangleScene(mesh), result.transform, builder, progress);
  } else {
    FillOptions fill;
    fill.rule = rule;
    fill.rim = winding ? &*winding : nullptr;
    if (options.rule == VoxelRule::Centre) {
      rasterizeBoundary(snapped, chain, fill, builder, progress);
    } else {
      RuleSink sink(builder, snapped, chain, options.rule, progress);
      rasterizeBoundary(snapped, chain, fill, sink, progress);
      sink.finish();
    }
  }
  timer.part("tree");
  auto grids = std::make_shared<GridSet>();
  grids->all = builder.finish(result.transform);
  result.volume = Volume(std::move(grids));

  if (!options.allowEmpty && result.volume.grids().all.front()->empty())
    throw Error(Status::Invalid, "", whyEmpty(rim, solid), emptyAdvice(rim, solid));
  if (solid.shell == 0 && !rim.edges.empty())
    warnIfThin(result.volume.grids().all.front()->activeVoxelCount(), surfaceVoxels, report);
  return result;
}

} // namespace tetvdb
