// SPDX-License-Identifier: Apache-2.0
//
// Level sets against openvdb::tools::meshToVolume, coverage, and the rules of voxels: cases
// levelset, coverage and rules.
#include "Cases.h"
#include "MeshToVolumePeer.h"
#include "fields/BruteDistance.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <openvdb/tools/Diagnostics.h>
#include <tbb/parallel_for.h>
#include <vector>

namespace tetvdb::bench {
namespace {

// The largest and the mean difference from the distance by brute force, voxels, over some 2000 of
// the active voxels.
struct Errors {
  double largest = 0, mean = 0;
};

// Over the faces whose box is within `reach` of p; none further away is asked.
long double distanceWithin(const openvdb::Vec3d& p, double reach, const TriangleMesh& mesh) {
  long double nearest = std::numeric_limits<long double>::infinity();
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
    const Vec3d* corner[3];
    for (std::size_t i = 0; i < 3; ++i)
      corner[i] = &mesh.points[mesh.triangles[3 * t + i]];
    bool near = true;
    for (std::size_t k = 0; k < 3 && near; ++k) {
      const auto [low, high] = std::minmax({(*corner[0])[k], (*corner[1])[k], (*corner[2])[k]});
      near = p[static_cast<int>(k)] >= low - reach && p[static_cast<int>(k)] <= high + reach;
    }
    if (!near)
      continue;
    const auto point = [](const auto& q) { return oracle::Point{q[0], q[1], q[2]}; };
    nearest = std::min(nearest, oracle::distanceToTriangle(point(p), point(*corner[0]),
                                                           point(*corner[1]), point(*corner[2])));
  }
  return nearest;
}

// A value that is too small by more than a voxel and a half finds no face, and counts as infinitely
// wrong.
Errors errorsOf(const openvdb::FloatGrid& grid, const TriangleMesh& mesh, double voxel) {
  std::vector<std::pair<openvdb::Coord, double>> sample;
  const std::uint64_t every = grid.activeVoxelCount() / 2000 + 1;
  std::uint64_t number = 0;
  for (auto v = grid.cbeginValueOn(); v; ++v)
    if (number++ % every == 0)
      sample.emplace_back(v.getCoord(), std::abs(static_cast<double>(*v)));
  std::vector<double> errors(sample.size());
  tbb::parallel_for(std::size_t(0), sample.size(), [&](std::size_t i) {
    const auto& [at, value] = sample[i];
    const long double exact = distanceWithin(at.asVec3d() * voxel, value + 1.5 * voxel, mesh);
    errors[i] = std::abs(value - static_cast<double>(exact)) / voxel;
  });
  Errors result;
  for (const double e : errors) {
    result.largest = std::max(result.largest, e);
    result.mean += e / static_cast<double>(errors.size());
  }
  return result;
}

double stageSeconds(const Report& report) {
  double seconds = 0;
  for (const Stage& stage : report.stages)
    seconds += stage.seconds;
  return seconds;
}

std::string partsOf(const Report& report) {
  std::string text;
  for (const Stage& stage : report.stages)
    for (const StagePart& part : stage.parts)
      if (part.seconds > 0.001)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", part.name, duration(part.seconds));
  return text;
}

// Stages voxelize and fields together.
template <typename... Mesh>
openvdb::GridBase::Ptr makeShape(GridKind kind, int resolution, Report& report, ShapeSums& sums,
                                 const Mesh&... mesh) {
  VoxelizeOptions options;
  options.resolution = resolution;
  options.grids = {GridKind::Mask};
  ShapeOptions shapes;
  shapes.grids = {kind};
  Progress progress;
  Voxelization made = voxelize(mesh..., options, report, progress);
  sums = addShapeGrids(mesh..., shapes, made, report, progress);
  return made.volume.grids().all.back();
}

} // namespace

void runLevelSet(const Setup& setup, Tables& tables) {
  tables.begin("levelset",
               "A level set of half-width 3 of a bumpy sphere's triangles: stages voxelize and "
               "fields, from points in memory to the finished tree, against the call of "
               "openvdb::tools::meshToVolume alone. Errors are against distances by brute force "
               "in long doubles, at 2000 voxels. The target is 3 times as fast, and more exact.");
  for (const double faces : {1e4, 1e5, 1e6}) {
    const int resolution =
        std::max(16, static_cast<int>(1024 / std::sqrt(static_cast<double>(setup.shrink))));
    const TriangleMesh mesh = bumpySphere(faces / setup.shrink);
    VoxelizeOptions options;
    options.resolution = resolution;
    const GridTransform transform = chooseTransform(mesh, options);
    const double voxel = transform.voxelSize[0];
    Report last;
    openvdb::FloatGrid::Ptr ours, peer;
    const std::vector<Times> times =
        interleave({{"ours",
                     [&] {
                       ours.reset();
                       last = {};
                       ShapeSums sums;
                       ours = openvdb::gridPtrCast<openvdb::FloatGrid>(makeShape(
                           GridKind::Surface, resolution, last, sums, mesh, SolidOptions()));
                       return stageSeconds(last);
                     }},
                    {"meshToVolume",
                     [&] {
                       peer.reset();
                       return secondsOf([&] { peer = meshToVolume(mesh, transform); });
                     }}},
                   setup.rounds(5), true);
    const Errors errors = errorsOf(*ours, mesh, voxel), others = errorsOf(*peer, mesh, voxel);
    Row row;
    row.what = fmt::format("{} triangles, {}^3",
                           countName(static_cast<double>(mesh.triangleCount())), resolution);
    row.peerName = "meshToVolume";
    row.ours = times[0];
    row.peer = times[1];
    row.targetRatio = faces == 1e5 ? 3 : 0;
    row.note = fmt::format(
        "{}; error in voxels, largest and mean: ours {:.2g} and {:.2g}, peer {:.2g} and {:.2g}; "
        "active voxels {} and {}; checkLevelSet: {}",
        partsOf(last), errors.largest, errors.mean, others.largest, others.mean,
        ours->activeVoxelCount(), peer->activeVoxelCount(),
        openvdb::tools::checkLevelSet(*ours, 8).empty() ? "passed" : "failed");
    tables.add(row);
  }
  tables.end();
}

void runCoverage(const Setup& setup, Tables& tables) {
  tables.begin("coverage",
               "The exact share of every voxel, stages voxelize and fields, against the same "
               "program's mask by centres, which is what coverage costs more than. The target is "
               "3 s for 10^6 tets at 512^3.");
  struct Sample {
    const char* name;
    TetMesh mesh;
    int resolution;
    double target;
  };
  const int half = std::max(16, static_cast<int>(512 / std::sqrt(double(setup.shrink))));
  for (const Sample& sample : {Sample{"block", blockMesh(1e6 / setup.shrink), half, 3},
                               Sample{"ball", ballMesh(1e6 / setup.shrink), half, 3},
                               Sample{"ball", ballMesh(1e6 / setup.shrink), 2 * half, 0}}) {
    Report last;
    ShapeSums sums;
    openvdb::GridBase::Ptr grid;
    VoxelizeOptions mask;
    mask.grids = {GridKind::Mask};
    mask.resolution = sample.resolution;
    const std::vector<Times> times = interleave(
        {{"ours",
          [&] {
            grid.reset();
            last = {};
            grid = makeShape(GridKind::Coverage, sample.resolution, last, sums, sample.mesh);
            return stageSeconds(last);
          }},
         {"mask by centres", [&] { return timeOurs(sample.mesh, mask); }}},
        setup.rounds(5), true);
    long double volume = 0, sum = 0;
    for (std::size_t t = 0; t < sample.mesh.tetCount(); ++t) {
      oracle::Point p[4];
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t k = 0; k < 3; ++k)
          p[i][k] = sample.mesh.points[sample.mesh.tets[4 * t + i]][k];
      volume += std::abs(oracle::product(
                    oracle::from(p[0], p[1]),
                    oracle::perpendicular(oracle::from(p[0], p[2]), oracle::from(p[0], p[3])))) /
                6;
    }
    const auto& shares = static_cast<const openvdb::FloatGrid&>(*grid);
    for (auto v = shares.cbeginValueOn(); v; ++v)
      sum += static_cast<long double>(*v) * static_cast<long double>(v.getVoxelCount());
    const long double h = grid->voxelSize()[0];
    Row row;
    row.what =
        fmt::format("{}, {} tets, {}^3", sample.name,
                    countName(static_cast<double>(sample.mesh.tetCount())), sample.resolution);
    row.peerName = "mask by centres";
    row.ours = times[0];
    row.peer = times[1];
    row.targetSeconds = setup.shrink == 1 ? sample.target : 0;
    row.note = fmt::format("{}; sum of the floats / volume of the mesh - 1 = {:.1e}; {} leaves",
                           partsOf(last), static_cast<double>(sum * h * h * h / volume - 1),
                           shares.tree().leafCount());
    tables.add(row);
  }
  tables.end();
}

void runRules(const Setup& setup, Tables& tables) {
  tables.begin("rules", "Masks by --rule any and all, stage voxelize, against the rule centre.");
  const int resolution =
      std::max(16, static_cast<int>(1024 / std::sqrt(static_cast<double>(setup.shrink))));
  const TetMesh mesh = ballMesh(1e6 / setup.shrink);
  for (const VoxelRule rule : {VoxelRule::Any, VoxelRule::All}) {
    VoxelizeOptions options;
    options.grids = {GridKind::Mask};
    options.resolution = resolution;
    VoxelizeOptions ruled = options;
    ruled.rule = rule;
    OursResult ours, centre;
    const std::vector<Times> times =
        interleave({{"ours", [&] { return timeOurs(mesh, ruled, &ours); }},
                    {"centre", [&] { return timeOurs(mesh, options, &centre); }}},
                   setup.rounds(5), true);
    Row row;
    row.what = fmt::format("{}, ball, {} tets, {}^3", rule == VoxelRule::Any ? "any" : "all",
                           countName(static_cast<double>(mesh.tetCount())), resolution);
    row.peerName = "centre";
    row.ours = times[0];
    row.peer = times[1];
    row.note = fmt::format("{} voxels, {} by centres", ours.activeVoxels, centre.activeVoxels);
    tables.add(row);
  }
  tables.end();
}

} // namespace tetvdb::bench
