// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/SnappedMesh.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/voxelize/ChooseTransform.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace tetvdb {
namespace {

struct PointsBox {
  LatticePoint min{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                   std::numeric_limits<double>::infinity()};
  LatticePoint max{-std::numeric_limits<double>::infinity(),
                   -std::numeric_limits<double>::infinity(),
                   -std::numeric_limits<double>::infinity()};
  bool bad = false; // a coordinate that is not finite, or outside index space

  void join(const PointsBox& b) {
    min = {std::min(min.x, b.min.x), std::min(min.y, b.min.y), std::min(min.z, b.min.z)};
    max = {std::max(max.x, b.max.x), std::max(max.y, b.max.y), std::max(max.z, b.max.z)};
    bad = bad || b.bad;
  }
};

// Voxel coordinates are int32; a node's margin is kept free at both ends.
constexpr double kMaxVoxelIndex = 2147483648.0 - 8192.0;

// NaN fails every comparison.
bool isInIndexSpace(const Vec3d& p, const GridTransform& transform) {
  for (std::size_t k = 0; k < 3; ++k)
    if (!(std::abs((p[k] - transform.origin[k]) / transform.voxelSize[k]) < kMaxVoxelIndex))
      return false;
  return true;
}

[[noreturn]] void failOutsideIndexSpace() {
  throw Error(Status::Limit, "", "the mesh leaves 32-bit index space at this voxel size",
              "use larger voxels");
}

} // namespace

LatticeBox snapBox(const WorldBox& box, const GridTransform& transform) {
  if (!isInIndexSpace(box.min, transform) || !isInIndexSpace(box.max, transform))
    failOutsideIndexSpace();
  return {snapPoint(box.min, transform), snapPoint(box.max, transform)};
}

SnappedMesh snapPoints(const std::vector<Vec3d>& points, const GridTransform& transform,
                       Progress& progress) {
  progress.check();
  SnappedMesh snapped;
  snapped.pointCount = points.size();
  snapped.points.resize(points.size() + 1);
  snapped.points.back() = {0, 0, 0};
  const PointsBox box = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, points.size(), 16384), PointsBox{},
      [&](const tbb::blocked_range<std::size_t>& range, PointsBox local) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const Vec3d& p = points[i];
          if (!isInIndexSpace(p, transform)) {
            local.bad = true;
            continue;
          }
          const LatticePoint q = snapPoint(p, transform);
          snapped.points[i] = q;
          local.min = {std::min(local.min.x, q.x), std::min(local.min.y, q.y),
                       std::min(local.min.z, q.z)};
          local.max = {std::max(local.max.x, q.x), std::max(local.max.y, q.y),
                       std::max(local.max.z, q.z)};
        }
        return local;
      },
      [](PointsBox a, const PointsBox& b) {
        a.join(b);
        return a;
      });

  if (box.bad) {
    for (std::size_t i = 0; i < points.size(); ++i)
      for (double c : points[i])
        if (!std::isfinite(c))
          throw Error(Status::Invalid, "point " + std::to_string(i),
                      "a coordinate is not a finite number", "repair the mesh");
    failOutsideIndexSpace();
  }
  if (!points.empty()) {
    snapped.boxMin = box.min;
    snapped.boxMax = box.max;
  }
  return snapped;
}

SnappedMesh snapMesh(const TetMesh& mesh, const GridTransform& transform, Progress& progress) {
  SnappedMesh snapped = snapPoints(mesh.points, transform, progress);
  snapped.tets = mesh.tets.data();
  snapped.tetCount = mesh.tetCount();
  return snapped;
}

} // namespace tetvdb
