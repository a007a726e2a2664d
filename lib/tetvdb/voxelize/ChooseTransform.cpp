// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/ChooseTransform.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/voxelize/Slab.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

namespace tetvdb {
namespace {

// OpenVDB refuses a transform whose determinant is below this (openvdb/math/Maps.h).
constexpr double kMinVoxelVolume = 3e-15;
// Voxel coordinates are int32; a margin of two root children is kept at both ends.
constexpr double kMaxIndex = 2147483648.0 - 2 * kRootChildSize;

WorldBox join(WorldBox a, const WorldBox& b) {
  a.add(b);
  return a;
}

void add(WorldBox& box, const Vec3d& p) {
  for (std::size_t k = 0; k < 3; ++k) {
    box.min[k] = std::min(box.min[k], p[k]);
    box.max[k] = std::max(box.max[k], p[k]);
    box.finite = box.finite && std::isfinite(p[k]);
  }
}

} // namespace

void WorldBox::add(const WorldBox& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    min[k] = std::min(min[k], other.min[k]);
    max[k] = std::max(max[k], other.max[k]);
  }
  finite = finite && other.finite;
}

// Nearly always all points are in use, or at least those on the sides of the box of all points;
// then the indices need only be looked through for them.
WorldBox boxOfUsed(const std::vector<Vec3d>& points, const std::vector<std::uint32_t>& indices) {
  using Range = tbb::blocked_range<std::size_t>;
  const auto boxOf = [](std::size_t count, const auto& point) {
    return tbb::parallel_reduce(
        Range(0, count, 65536), WorldBox{},
        [&](const Range& range, WorldBox box) {
          for (std::size_t i = range.begin(); i != range.end(); ++i)
            add(box, point(i));
          return box;
        },
        join);
  };
  const WorldBox all = boxOf(points.size(), [&](std::size_t i) { return points[i]; });
  std::vector<std::uint8_t> sides(points.size());
  tbb::parallel_for(Range(0, points.size(), 65536), [&](const Range& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        sides[i] = static_cast<std::uint8_t>(sides[i] | (points[i][k] == all.min[k]) << k |
                                             (points[i][k] == all.max[k]) << (k + 3));
  });
  // From both ends inward: meshes tend to be numbered along an axis.
  std::atomic<int> used{0};
  const std::size_t chunk = 65536, chunks = (indices.size() + chunk - 1) / chunk;
  tbb::parallel_for(
      Range(0, chunks, 1),
      [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end() && used != 0x3F; ++i) {
          const std::size_t at = i % 2 == 0 ? i / 2 : chunks - 1 - i / 2;
          int found = 0;
          for (std::size_t k = at * chunk; k < std::min((at + 1) * chunk, indices.size()); ++k)
            found |= sides[indices[k]];
          used |= found;
        }
      },
      tbb::simple_partitioner());
  if (all.finite && used == 0x3F)
    return all;
  return boxOf(indices.size(), [&](std::size_t i) { return points[indices[i]]; });
}

GridTransform chooseTransform(const WorldBox& box, const VoxelizeOptions& options) {
  GridTransform transform;
  transform.voxelSize = options.voxelSize;
  transform.origin = options.origin;
  for (double c : options.origin)
    if (!std::isfinite(c))
      throw Error(Status::Usage, "--origin", "not a finite number");
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

void reportOrigin(const GridTransform& transform, const VoxelizeOptions& options, Report& report) {
  if (transform.origin == options.origin)
    return;
  report.warn("origin-moved",
              fmt::format("the mesh lies outside 32-bit index space; the origin was moved to "
                          "{}, {}, {}, a multiple of {} voxels",
                          transform.origin[0], transform.origin[1], transform.origin[2],
                          kRootChildSize));
}

} // namespace tetvdb
