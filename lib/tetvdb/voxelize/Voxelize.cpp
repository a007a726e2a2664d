// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/Voxelize.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/BoundaryRaster.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/TetNodes.h"
#include "tetvdb/voxelize/TreeBuilder.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <utility>

namespace tetvdb {
namespace {

// OpenVDB refuses a transform whose determinant is below this (openvdb/math/Maps.h).
constexpr double kMinVoxelVolume = 3e-15;
// Voxel coordinates are int32; a margin of two root children is kept at both ends.
constexpr double kMaxIndex = 2147483648.0 - 2 * kRootChildSize;

struct Box {
  Vec3d min{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
            std::numeric_limits<double>::infinity()};
  Vec3d max{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
            -std::numeric_limits<double>::infinity()};
  bool finite = true;
};

Box join(Box a, const Box& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    a.min[k] = std::min(a.min[k], b.min[k]);
    a.max[k] = std::max(a.max[k], b.max[k]);
  }
  a.finite = a.finite && b.finite;
  return a;
}

void add(Box& box, const Vec3d& p) {
  for (std::size_t k = 0; k < 3; ++k) {
    box.min[k] = std::min(box.min[k], p[k]);
    box.max[k] = std::max(box.max[k], p[k]);
    box.finite = box.finite && std::isfinite(p[k]);
  }
}

// Box of the points that tets use. Nearly always these are all points, or at least those on the
// sides of the box of all points; then the tets' indices need only be looked through for them.
Box tetBox(const TetMesh& mesh) {
  using Range = tbb::blocked_range<std::size_t>;
  const auto boxOf = [](std::size_t count, const auto& point) {
    return tbb::parallel_reduce(
        Range(0, count, 65536), Box{},
        [&](const Range& range, Box box) {
          for (std::size_t i = range.begin(); i != range.end(); ++i)
            add(box, point(i));
          return box;
        },
        join);
  };
  const Box all = boxOf(mesh.points.size(), [&](std::size_t i) { return mesh.points[i]; });
  std::vector<std::uint8_t> sides(mesh.points.size());
  tbb::parallel_for(Range(0, mesh.points.size(), 65536), [&](const Range& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        sides[i] = static_cast<std::uint8_t>(sides[i] | (mesh.points[i][k] == all.min[k]) << k |
                                             (mesh.points[i][k] == all.max[k]) << (k + 3));
  });
  // From both ends inward: meshes tend to be numbered along an axis.
  std::atomic<int> used{0};
  const std::size_t chunk = 65536, chunks = (mesh.tets.size() + chunk - 1) / chunk;
  tbb::parallel_for(
      Range(0, chunks, 1),
      [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end() && used != 0x3F; ++i) {
          const std::size_t at = i % 2 == 0 ? i / 2 : chunks - 1 - i / 2;
          int found = 0;
          for (std::size_t k = at * chunk; k < std::min((at + 1) * chunk, mesh.tets.size()); ++k)
            found |= sides[mesh.tets[k]];
          used |= found;
        }
      },
      tbb::simple_partitioner());
  if (all.finite && used == 0x3F)
    return all;
  return boxOf(mesh.tets.size(), [&](std::size_t i) { return mesh.points[mesh.tets[i]]; });
}

bool needsOwner(GridKind kind) {
  return kind == GridKind::TetId || kind == GridKind::Material;
}

// Memory for leaves and lower nodes.
struct TreeEstimate {
  double leaves = 0;
  double lowerNodes = 0;

  double bytes(const std::vector<GridKind>& grids) const {
    double leaf = 0;
    for (GridKind kind : grids)
      leaf += static_cast<double>(leafBytes(kind));
    return leaves * leaf +
           lowerNodes * static_cast<double>(kLowerNodeBytes) * static_cast<double>(grids.size());
  }
};

// Nodes that hold the box: never more than these.
TreeEstimate estimateByBox(const SnappedMesh& mesh) {
  const auto nodes = [&](int shift) {
    const auto along = [&](double low, double high) {
      return static_cast<double>((floorVoxel(high) >> shift) - (ceilVoxel(low) >> shift) + 1);
    };
    return std::max(along(mesh.boxMin.x, mesh.boxMax.x), 0.0) *
           std::max(along(mesh.boxMin.y, mesh.boxMax.y), 0.0) *
           std::max(along(mesh.boxMin.z, mesh.boxMax.z), 0.0);
  };
  return {nodes(3), nodes(7)};
}

// Nodes that a surface of so many leaves meets: about 1 / 256 of the leaves lie in a lower node,
// and small parts have a node for themselves.
TreeEstimate estimateByBoundary(const SnappedMesh& mesh, const Boundary& boundary) {
  const auto leaves = static_cast<double>(estimateBoundaryLeaves(mesh, boundary));
  const TreeEstimate box = estimateByBox(mesh);
  return {std::min(leaves, box.leaves), std::min(leaves / 128 + 64, box.lowerNodes)};
}

// Leaves with owners: those that faces pass through, and no more than those that the tets fill.
TreeEstimate estimateByTets(const SnappedMesh& mesh) {
  struct Sum {
    double volume = 0, area = 0;
  };
  const Sum sum = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.tetCount, 16384), Sum{},
      [&](const tbb::blocked_range<std::size_t>& range, Sum s) {
        for (std::size_t t = range.begin(); t != range.end(); ++t) {
          const std::uint32_t* v = mesh.tets + 4 * t;
          double e[3][3];
          for (int i = 0; i < 3; ++i) {
            const LatticePoint &p = mesh.points[v[i + 1]], &o = mesh.points[v[0]];
            e[i][0] = (p.x - o.x) * kVoxelsPerUnit;
            e[i][1] = (p.y - o.y) * kVoxelsPerUnit;
            e[i][2] = (p.z - o.z) * kVoxelsPerUnit;
          }
          double det = 0, area = 0, rest[3] = {0, 0, 0};
          for (int i = 0; i < 3; ++i) {
            const double* a = e[i];
            const double* b = e[(i + 1) % 3];
            const double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                 a[0] * b[1] - a[1] * b[0]};
            for (int k = 0; k < 3; ++k) {
              area += std::abs(n[k]);
              rest[k] += n[k];
            }
            if (i == 0)
              det = n[0] * e[2][0] + n[1] * e[2][1] + n[2] * e[2][2];
          }
          area += std::abs(rest[0]) + std::abs(rest[1]) + std::abs(rest[2]);
          s.volume += std::abs(det) / 6;
          s.area += area / 2;
        }
        return s;
      },
      [](Sum a, const Sum& b) {
        return Sum{a.volume + b.volume, a.area + b.area};
      });
  const TreeEstimate box = estimateByBox(mesh);
  // Interior faces are counted by both their tets. A leaf at the surface is partly outside: a third
  // more for those of thin or small meshes.
  const double leaves = std::min(sum.area / 2 / 64, sum.volume / 512 * 1.35) + 64;
  return {std::min(leaves, box.leaves), std::min(leaves / 128 + 64, box.lowerNodes)};
}

void requireMemory(double bytes, const VoxelizeOptions& options) {
  const std::size_t limit = options.maxMemory != 0 ? options.maxMemory : availableBytes();
  if (bytes <= static_cast<double>(limit))
    return;
  throw Error(Status::Limit, "",
              fmt::format("voxelizing needs about {:.2f} GB, the limit is {:.2f} GB", bytes * 1e-9,
                          static_cast<double>(limit) * 1e-9),
              options.maxMemory != 0
                  ? "raise --max-memory, use larger voxels or fewer grids"
                  : "use larger voxels, fewer grids or a machine with more memory");
}

// The rates behind the choice of path, seconds on one core, as `tetvdb_bench paths` measures them.
constexpr double kSecondsPerTetMatched = 30e-9;  // boundary path: a tet whose faces cancel
constexpr double kSecondsPerOpenFace = 500e-9;   // a face that does not, matched and rasterised
constexpr double kSecondsPerTetPrepared = 70e-9; // tet path: a tet read and its planes found
constexpr double kSecondsPerColumn = 12e-9;      // a column of its box bounded

// Whether rasterizing every tet beats finding the boundary. It does for tets that share no points,
// so that every face stays open, as long as they are small.
bool tetsAreFaster(const SnappedMesh& mesh) {
  const auto tets = static_cast<double>(mesh.tetCount);
  // A welded mesh has about a fifth as many points as tets, a soup four times as many.
  const double open =
      std::clamp((static_cast<double>(mesh.pointCount) / tets - 0.3) / 3.7, 0.0, 1.0);
  const auto columns = [](double low, double high) { return (high - low) * kVoxelsPerUnit + 1; };
  const double volume = columns(mesh.boxMin.x, mesh.boxMax.x) *
                        columns(mesh.boxMin.y, mesh.boxMax.y) *
                        columns(mesh.boxMin.z, mesh.boxMax.z);
  // Edge of a regular tet that takes its share of the box, and the columns its own box covers.
  const double edge = std::cbrt(volume / tets * 6 * std::sqrt(2.0));
  const double boundaryPath = kSecondsPerTetMatched + 4 * open * kSecondsPerOpenFace;
  const double tetPath = kSecondsPerTetPrepared + kSecondsPerColumn * (edge + 1) * (edge + 1);
  return tetPath < boundaryPath;
}

} // namespace

GridTransform chooseTransform(const TetMesh& mesh, const VoxelizeOptions& options) {
  GridTransform transform;
  transform.voxelSize = options.voxelSize;
  transform.origin = options.origin;
  for (double c : options.origin)
    if (!std::isfinite(c))
      throw Error(Status::Usage, "--origin", "not a finite number");
  const Box box = tetBox(mesh);
  if (mesh.tets.empty())
    throw Error(Status::Invalid, "", "the mesh has no tetrahedra");
  if (!box.finite)
    throw Error(Status::Invalid, "", "a coordinate of the mesh is not a finite number",
                "repair the mesh");

  const Vec3d& h = options.voxelSize;
  if (h[0] == 0 && h[1] == 0 && h[2] == 0) {
    if (options.resolution < 1)
      throw Error(Status::Usage, "--resolution", "must be 1 or more");
    const double longest =
        std::max({box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]});
    if (!(longest > 0))
      throw Error(Status::Invalid, "", "all points of the mesh coincide");
    const double size = longest / options.resolution;
    transform.voxelSize = {size, size, size};
  }
  const Vec3d& size = transform.voxelSize;
  for (double s : size)
    if (!(s > 0) || !std::isfinite(s))
      throw Error(Status::Usage, "--voxel-size", fmt::format("{} is not a positive length", s));
  if (size[0] * size[1] * size[2] < kMinVoxelVolume)
    throw Error(
        h[0] == 0 ? Status::Limit : Status::Usage, h[0] == 0 ? "--resolution" : "--voxel-size",
        fmt::format("a voxel of {:.4g} x {:.4g} x {:.4g} is below OpenVDB's smallest volume, "
                    "3e-15 cubic units (1.45e-5 a side)",
                    size[0], size[1], size[2]),
        "use larger voxels, or scale the model to a smaller unit: millimetres for metres");

  for (std::size_t k = 0; k < 3; ++k) {
    const double extent = (box.max[k] - box.min[k]) / size[k];
    if (!(extent < 2 * kMaxIndex - kRootChildSize))
      throw Error(
          Status::Limit, h[0] == 0 ? "--resolution" : "--voxel-size",
          fmt::format("the mesh is {:.4g} voxels long, more than 32-bit index space holds", extent),
          "use larger voxels");
    const double low = (box.min[k] - transform.origin[k]) / size[k];
    const double high = (box.max[k] - transform.origin[k]) / size[k];
    if (low > -kMaxIndex && high < kMaxIndex)
      continue;
    // By whole root children, so that grids of one voxel size stay aligned.
    const double steps = std::floor((low + high) / 2 / kRootChildSize);
    transform.origin[k] += steps * kRootChildSize * size[k];
  }
  return transform;
}

Voxelization voxelize(const TetMesh& mesh, const VoxelizeOptions& options, Report& report,
                      Progress& progress) {
  progress.stage("voxelize");
  if (options.grids.empty())
    throw Error(Status::Usage, "--grid", "no grid was asked for");
  if (mesh.tetCount() >= 0xFFFFFFFFu)
    throw Error(Status::Limit, "", "the mesh has 2^32 tets or more", "split it in parts");
  const bool owners = std::any_of(options.grids.begin(), options.grids.end(), needsOwner);
  if (owners && mesh.cellCount > 0x7FFFFFFFu)
    throw Error(Status::Limit, "", "more than 2^31 cells cannot be numbered in an int32 grid");
  initializeOpenVDB();

  StageTimer timer(report, "voxelize");
  Voxelization result;
  timer.part("transform");
  result.transform = chooseTransform(mesh, options);
  if (result.transform.origin != options.origin)
    report.warn("origin-moved",
                fmt::format("the mesh lies outside 32-bit index space; the origin was moved to "
                            "{}, {}, {}, a multiple of {} voxels",
                            result.transform.origin[0], result.transform.origin[1],
                            result.transform.origin[2], kRootChildSize));
  timer.part("snap");
  const SnappedMesh snapped = snapMesh(mesh, result.transform, progress);

  const bool tets = owners || options.path == OccupancyPath::Tets ||
                    (options.path == OccupancyPath::Auto && tetsAreFaster(snapped));
  result.path = tets ? OccupancyPath::Tets : OccupancyPath::Boundary;
  TreeBuilder builder(options.grids, mesh);
  const auto bytesPerTet = tets ? 16.0 : 40.0;
  const double working = 24.0 * static_cast<double>(snapped.pointCount) +
                         bytesPerTet * static_cast<double>(snapped.tetCount);
  const auto estimate = [&](const TreeEstimate& tree) {
    const double bytes = working + tree.bytes(options.grids);
    result.estimatedBytes = static_cast<std::size_t>(bytes);
    return bytes;
  };

  if (tets) {
    // The box bounds everything; only where that is too much are the tets looked at.
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
    const Boundary boundary = boundaryFaces(snapped, progress);
    result.counts = {boundary.flipped, boundary.dropped, boundary.faces.size()};
    timer.part("estimate");
    requireMemory(estimate(estimateByBoundary(snapped, boundary)), options);
    timer.part("rasterize");
    rasterizeBoundary(snapped, boundary, builder, progress);
  }
  timer.part("tree");
  auto grids = std::make_shared<GridSet>();
  grids->all = builder.finish(result.transform);
  result.volume = Volume(std::move(grids));

  if (result.counts.flipped > 0)
    report.warn("flipped-tets",
                fmt::format("{} of {} tets had negative volume and were turned round",
                            result.counts.flipped, snapped.tetCount));
  if (result.counts.dropped > 0)
    report.warn("flat-tets",
                fmt::format("{} of {} tets have no volume on the lattice of 2^-20 voxel "
                            "and were left out",
                            result.counts.dropped, snapped.tetCount));
  if (!options.allowEmpty && result.volume.grids().all.front()->empty())
    throw Error(Status::Invalid, "", "no voxel centre lies inside the mesh",
                "use smaller voxels, or --allow-empty to write an empty grid");
  return result;
}

} // namespace tetvdb
