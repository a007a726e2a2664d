// SPDX-License-Identifier: Apache-2.0
//
// Voxels of real files by the winding number and by the centroid covering: case centroid.
#include "Cases.h"
#include "CentroidCovering.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/TriangleReader.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/SoupBoundary.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <filesystem>
#include <fmt/format.h>

namespace tetvdb::bench {
namespace {

openvdb::BoolGrid::Ptr maskOf(const TriangleMesh& mesh, InsideRule rule,
                              const VoxelizeOptions& options, double& seconds) {
  Report report;
  Progress progress;
  SolidOptions solid;
  solid.inside = rule;
  const Voxelization made = voxelize(mesh, solid, options, report, progress);
  seconds = report.stages.back().seconds;
  return openvdb::gridPtrCast<openvdb::BoolGrid>(made.volume.grids().all.front());
}

void compare(const std::string& path, const Setup& setup, Tables& tables) {
  Report report;
  Progress progress;
  TriangleMesh mesh = readTriangles(path, report, progress);
  cleanTriangles(mesh, {}, progress);
  const TriangleMesh covering = centroidCovering(mesh);

  VoxelizeOptions options;
  options.resolution = shrunk(256, setup);
  options.grids = {GridKind::Mask};
  options.allowEmpty = true;
  const GridTransform transform = chooseTransform(mesh, options);
  options.voxelSize = transform.voxelSize;
  options.origin = transform.origin;

  openvdb::BoolGrid::Ptr ours, theirs;
  const auto timed = [&](const TriangleMesh& faces, InsideRule rule, openvdb::BoolGrid::Ptr& mask) {
    double seconds = 0;
    mask = maskOf(faces, rule, options, seconds);
    return seconds;
  };
  const std::vector<Times> times =
      interleave({{"winding", [&] { return timed(mesh, InsideRule::Winding, ours); }},
                  {"covering", [&] { return timed(covering, InsideRule::Parity, theirs); }}},
                 setup.rounds(3), false);
  const std::uint64_t winding = ours->activeVoxelCount(), parity = theirs->activeVoxelCount();
  const openvdb::BoolGrid::Ptr both = ours->deepCopy();
  both->topologyIntersection(*theirs);
  const auto common = static_cast<double>(both->activeVoxelCount());
  const double all = static_cast<double>(winding + parity) - common;
  Row row;
  row.what = fmt::format("{}, {} open edges", std::filesystem::path(path).filename().string(),
                         soupBoundary(mesh, progress).edges.size());
  row.peerName = "centroid covering";
  row.ours = times[0];
  row.peer = times[1];
  row.note = fmt::format("{} voxels, by the peer {}: IoU {:.4f}", winding, parity,
                         all > 0 ? common / all : 1);
  tables.add(row);
}

} // namespace

void runCentroid(const Setup& setup, Tables& tables) {
  tables.begin("centroid",
               fmt::format("A mask of {}^3: stage `voxelize` by the winding number, and by the "
                           "parity of the centroid covering.",
                           shrunk(256, setup)));
  if (setup.meshes.empty())
    throw Error(Status::Usage, "centroid", "has no files", "name some with --mesh");
  for (const std::string& mesh : setup.meshes)
    compare(mesh, setup, tables);
  tables.end();
}

} // namespace tetvdb::bench
