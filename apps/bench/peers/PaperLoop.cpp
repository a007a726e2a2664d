// SPDX-License-Identifier: Apache-2.0
#include "PaperLoop.h"

#include "PhilippB.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cmath>
#ifdef _OPENMP
#include <omp.h>
#endif

namespace tetvdb::bench {
namespace {

using Test = PhilippB<double>;
using Corners = std::array<Test::Point, 4>;

template <typename Value>
constexpr Value outside = std::is_same<Value, std::uint8_t>::value ? Value(0) : Value(-1);

Vec3d toIndex(const Vec3d& p, const GridTransform& t) {
  return {(p[0] - t.origin[0]) / t.voxelSize[0], (p[1] - t.origin[1]) / t.voxelSize[1],
          (p[2] - t.origin[2]) / t.voxelSize[2]};
}

/// Calls write(x, y, z) for every voxel centre that the paper's test finds inside the tet.
template <typename Write>
void forVoxelsInside(const Corners& tet, const Write& write) {
  int low[3], high[3];
  for (std::size_t k = 0; k < 3; ++k) {
    low[k] = static_cast<int>(std::ceil(std::min({tet[0][k], tet[1][k], tet[2][k], tet[3][k]})));
    high[k] = static_cast<int>(std::floor(std::max({tet[0][k], tet[1][k], tet[2][k], tet[3][k]})));
  }
  for (int x = low[0]; x <= high[0]; ++x)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int z = low[2]; z <= high[2]; ++z)
        if (Test::inside(tet, {double(x), double(y), double(z)}))
          write(x, y, z);
}

Corners cornersOf(const TetMesh& mesh, const std::vector<Vec3d>& points, std::size_t t) {
  const std::uint32_t* v = mesh.tets.data() + 4 * t;
  return {points[v[0]], points[v[1]], points[v[2]], points[v[3]]};
}

} // namespace

VoxelBox voxelBox(const TetMesh& mesh, const GridTransform& transform) {
  Vec3d low = toIndex(mesh.points.front(), transform), high = low;
  for (const Vec3d& point : mesh.points) {
    const Vec3d p = toIndex(point, transform);
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  VoxelBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.min[k] = static_cast<std::int32_t>(std::ceil(low[k]));
    box.size[k] = static_cast<std::int32_t>(std::floor(high[k])) - box.min[k] + 1;
  }
  return box;
}

template <typename Value>
PaperLoop<Value>::PaperLoop(const TetMesh& mesh, const GridTransform& transform)
    : mesh_(mesh), transform_(transform), box_(voxelBox(mesh, transform)),
      points_(mesh.points.size()), grid_(box_.count(), outside<Value>) {}

template <typename Value>
void PaperLoop<Value>::run() {
  const auto pointCount = static_cast<std::int64_t>(points_.size());
  const auto tetCount = static_cast<std::int64_t>(mesh_.tetCount());
  const auto rows = static_cast<std::int64_t>(box_.size[0]);
  const auto rowSize = box_.count() / static_cast<std::size_t>(rows);
#pragma omp parallel
  {
#pragma omp for schedule(static)
    for (std::int64_t i = 0; i < pointCount; ++i)
      points_[static_cast<std::size_t>(i)] =
          toIndex(mesh_.points[static_cast<std::size_t>(i)], transform_);
#pragma omp for schedule(static)
    for (std::int64_t x = 0; x < rows; ++x)
      std::fill_n(grid_.data() + static_cast<std::size_t>(x) * rowSize, rowSize, outside<Value>);
#pragma omp for schedule(dynamic, 1024)
    for (std::int64_t t = 0; t < tetCount; ++t) {
      const auto value =
          std::is_same<Value, std::uint8_t>::value ? Value(1) : static_cast<Value>(t);
      forVoxelsInside(
          cornersOf(mesh_, points_, static_cast<std::size_t>(t)), [&](int x, int y, int z) {
            const auto at =
                (static_cast<std::int64_t>(x - box_.min[0]) * box_.size[1] + (y - box_.min[1])) *
                    box_.size[2] +
                (z - box_.min[2]);
            grid_[static_cast<std::size_t>(at)] = value;
          });
    }
  }
}

template <typename Value>
std::size_t PaperLoop<Value>::activeVoxels() const {
  return grid_.size() -
         static_cast<std::size_t>(std::count(grid_.begin(), grid_.end(), outside<Value>));
}

template class PaperLoop<std::uint8_t>;
template class PaperLoop<std::int32_t>;

std::size_t accessorLoop(const TetMesh& mesh, const GridTransform& transform) {
  initializeOpenVDB();
  std::vector<Vec3d> points(mesh.points.size());
  std::transform(mesh.points.begin(), mesh.points.end(), points.begin(),
                 [&](const Vec3d& p) { return toIndex(p, transform); });
  openvdb::BoolGrid grid(false);
  auto accessor = grid.getAccessor();
  for (std::size_t t = 0; t < mesh.tetCount(); ++t)
    forVoxelsInside(cornersOf(mesh, points, t), [&](int x, int y, int z) {
      accessor.setValueOn(openvdb::Coord(x, y, z), true);
    });
  return grid.activeVoxelCount();
}

void setLoopThreads(int threads) {
#ifdef _OPENMP
  omp_set_num_threads(threads);
#else
  (void)threads;
#endif
}

bool haveOpenMP() {
#ifdef _OPENMP
  return true;
#else
  return false;
#endif
}

} // namespace tetvdb::bench
