// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/Voxelize.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/BoundaryRaster.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/RuleSink.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/TetNodes.h"
#include "tetvdb/voxelize/TreeBuilder.h"
#include "tetvdb/voxelize/TreeEstimate.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace tetvdb {
namespace {

// The rates that the choice of method is based on, in seconds on one core, as `tetvdb_bench paths`
// measures them.
constexpr double kSecondsPerTetMatched = 15e-9;  // by the boundary: a tet whose faces cancel
constexpr double kSecondsPerOpenFace = 500e-9;   // a face that does not, matched and rasterised
constexpr double kSecondsPerTetPrepared = 70e-9; // tet by tet: a tet read and its planes computed
constexpr double kSecondsPerColumn = 12e-9;      // a column of its box bounded

// Whether rasterizing every tet beats finding the boundary. It does for tets that share no points,
// so that every face stays open, as long as they are small.
bool tetsAreFaster(const TetMesh& mesh, const LatticeBox& box) {
  const auto tets = static_cast<double>(mesh.tetCount());
  // A welded mesh has about a fifth as many points as tets, a soup four times as many.
  const double open =
      std::clamp((static_cast<double>(mesh.points.size()) / tets - 0.3) / 3.7, 0.0, 1.0);
  const auto columns = [](double low, double high) { return (high - low) * kVoxelsPerUnit + 1; };
  const double volume = columns(box.low.x, box.high.x) * columns(box.low.y, box.high.y) *
                        columns(box.low.z, box.high.z);
  // Edge of a regular tet that takes its share of the box, and the columns its own box covers.
  const double edge = std::cbrt(volume / tets * 6 * std::sqrt(2.0));
  const double boundaryPath = kSecondsPerTetMatched + 4 * open * kSecondsPerOpenFace;
  const double tetPath = kSecondsPerTetPrepared + kSecondsPerColumn * (edge + 1) * (edge + 1);
  return tetPath < boundaryPath;
}

void requireTets(const TetMesh& mesh) {
  if (mesh.tets.empty())
    throw Error(Status::Invalid, "", "the mesh has no tetrahedra");
}

} // namespace

GridTransform chooseTransform(const TetMesh& mesh, const VoxelizeOptions& options) {
  requireTets(mesh);
  return chooseTransform(boxOfUsed(mesh.points, mesh.tets), options);
}

void checkTets(const TetMesh& mesh, const VoxelizeOptions& options) {
  checkMesh(mesh);
  if (mesh.tetCount() >= 0xFFFFFFFFu)
    throw Error(Status::Limit, "", "the mesh has 2^32 tets or more", "split it in parts");
  const bool owners = !madeBy(options.grids, {GridMaker::Owner}).empty();
  if (owners && mesh.cellCount > 0x7FFFFFFFu)
    throw Error(Status::Limit, "", "more than 2^31 cells cannot be numbered in an int32 grid");
  if (options.rule != VoxelRule::Centre && (owners || options.path == OccupancyPath::Tets))
    throw Error(Status::Usage, "`rule`",
                "any and all are found from the boundary; voxels of tet_id, material and `path` "
                "tets go by their centre",
                "leave one of them out");
}

void reportTets(const SnapCounts& counts, std::size_t tets, Report& report) {
  if (counts.flipped > 0)
    report.warn("flipped-tets", fmt::format("{} of {} tets had negative volume and were reversed",
                                            counts.flipped, tets));
  if (counts.dropped > 0)
    report.warn("flat-tets", fmt::format("{} of {} tets have no volume on the lattice of 2^-20 "
                                         "voxel and were left out",
                                         counts.dropped, tets));
}

void requireVoxels(const Voxelization& result, const VoxelizeOptions& options) {
  requireVoxels(result.volume.grids().all.front()->empty(), options);
}

void requireVoxels(bool empty, const VoxelizeOptions& options) {
  if (!options.allowEmpty && empty)
    throw Error(Status::Invalid, "",
                options.rule == VoxelRule::All ? "no voxel lies wholly inside the mesh"
                                               : "no voxel centre lies inside the mesh",
                "use smaller voxels, or `allow_empty` to write an empty grid");
}

Voxelization voxelize(const TetMesh& mesh, const VoxelizeOptions& options, Report& report,
                      Progress& progress) {
  progress.stage("voxelize");
  checkGridKinds(options.grids, {GridMaker::Occupancy, GridMaker::Owner});
  checkTets(mesh, options);
  const bool owners = !madeBy(options.grids, {GridMaker::Owner}).empty();
  const bool byCentre = options.rule == VoxelRule::Centre;
  initializeOpenVDB();

  StageTimer timer(report, "voxelize");
  Voxelization result;
  timer.part("transform");
  requireTets(mesh);
  const PointBoxes boxes = boxesOf(mesh.points, mesh.tets);
  result.transform = chooseTransform(boxes.used, options);
  reportTransform(result.transform, options, report);
  const LatticeBox box = snapBox(boxes.all, result.transform);

  const bool tets = owners || options.path == OccupancyPath::Tets ||
                    (byCentre && options.path == OccupancyPath::Auto && tetsAreFaster(mesh, box));
  result.path = tets ? OccupancyPath::Tets : OccupancyPath::Boundary;
  TreeBuilder builder(options.grids, mesh);
  const auto bytesPerTet = tets ? 16.0 : 40.0;
  const double working = 24.0 * static_cast<double>(mesh.points.size()) +
                         bytesPerTet * static_cast<double>(mesh.tetCount());
  const auto estimate = [&](const TreeEstimate& tree) {
    const double bytes = working + tree.bytes(options.grids);
    result.estimatedBytes = static_cast<std::size_t>(bytes);
    return bytes;
  };

  if (tets) {
    timer.part("snap");
    const SnappedMesh snapped = snapMesh(mesh, result.transform, progress);
    // The box is a bound for all of them; the tets are examined only if that bound is too large.
    timer.part("estimate");
    const std::size_t limit = options.maxMemory != 0 ? options.maxMemory : availableBytes();
    if (estimate(estimateByBox(snapped)) > static_cast<double>(limit))
      requireMemory(estimate(estimateByTets(snapped)), options);
    timer.part("rasterize");
    const OrientationCounts counts = rasterizeNodes(snapped, owners, builder, progress);
    result.counts.flipped = counts.flipped;
    result.counts.dropped = counts.dropped;
  } else {
    requireMemory(working, options);
    timer.part("boundary");
    Boundary boundary = boundaryFaces(mesh, result.transform, progress);
    result.counts = {boundary.flipped, boundary.dropped, boundary.faces.size()};
    timer.part("snap");
    SnappedMesh snapped = snapUsed(mesh.points, boundary, result.transform, progress);
    snapped.boxMin = box.low;
    snapped.boxMax = box.high;
    timer.part("estimate");
    requireMemory(estimate(estimateByBoundary(snapped, boundary)), options);
    timer.part("rasterize");
    if (byCentre) {
      rasterizeBoundary(snapped, boundary, {}, builder, progress);
    } else {
      const RuledFaces faces(snapped, boundary, progress);
      RuleSink sink(builder, faces, options.rule, 0, faces.size());
      rasterizeBoundary(snapped, boundary, {}, sink, progress);
      sink.finish();
    }
  }
  timer.part("tree");
  auto grids = std::make_shared<GridSet>();
  grids->all = builder.finish(result.transform);
  result.volume = Volume(std::move(grids));

  reportTets(result.counts, mesh.tetCount(), report);
  requireVoxels(result, options);
  return result;
}

} // namespace tetvdb
