// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

constexpr double kSize = 0.5, kThickness = 2.3, kHalfWidth = 3;

Voxelization surfaceOf(const TriangleMesh& mesh, ShellSide side, double thickness = kThickness) {
  SolidOptions solid;
  solid.shell = thickness;
  solid.side = side;
  VoxelizeOptions options;
  options.voxelSize = {kSize, kSize, kSize};
  options.grids = {GridKind::Mask};
  ShapeOptions shapes;
  shapes.grids = {GridKind::Surface, GridKind::Fog};
  shapes.halfWidth = kHalfWidth;
  Report report;
  Progress progress;
  Voxelization made = voxelize(mesh, solid, options, report, progress);
  addShapeGrids(mesh, solid, shapes, made, report, progress);
  return made;
}

// Signed distance to a cuboid from 0 to `high`.
double toCuboid(const Vec3d& p, const Vec3d& high) {
  double outside = 0, inside = -1e9;
  for (std::size_t k = 0; k < 3; ++k) {
    const double past = std::max(-p[k], p[k] - high[k]);
    outside += past > 0 ? past * past : 0;
    inside = std::max(inside, past);
  }
  return outside > 0 ? std::sqrt(outside) : inside;
}

TEST(ShellSurface, OfACuboid) {
  const Vec3d high{11.1, 9.3, 8.7};
  for (const ShellSide side : {ShellSide::Outward, ShellSide::Inward}) {
    const Voxelization made = surfaceOf(meshes::box({0, 0, 0}, high, 2), side);
    const auto mask = openvdb::gridConstPtrCast<openvdb::BoolGrid>(made.volume.grids().all[0]);
    const auto grid = openvdb::gridConstPtrCast<openvdb::FloatGrid>(made.volume.grids().all[1]);
    const auto inside = mask->getConstAccessor();
    const auto surface = grid->getConstAccessor();
    EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
    EXPECT_EQ(grid->background(), float(kHalfWidth * kSize));
    EXPECT_EQ(describe(made.volume)[1].volume, describe(made.volume)[0].volume);
    int wrong = 0, inBand = 0;
    for (int x = -14; x < 38; ++x)
      for (int y = -14; y < 34; ++y)
        for (int z = -14; z < 34; ++z) {
          const double s = toCuboid({x * kSize, y * kSize, z * kSize}, high);
          const double f = side == ShellSide::Outward ? std::max(-s, s - kThickness)
                                                      : std::max(s, -kThickness - s);
          const openvdb::Coord at(x, y, z);
          const float found = surface.getValue(at);
          if (std::abs(f) > 1e-4)
            wrong += (found < 0) != (f < 0);
          wrong += (found < 0) != inside.isValueOn(at);
          if (std::abs(std::abs(f) - kHalfWidth * kSize) < 1e-4)
            continue;
          const bool band = std::abs(f) < kHalfWidth * kSize;
          inBand += band;
          wrong += surface.isValueOn(at) != band;
          wrong += std::abs(double(found) -
                            std::clamp(f, -kHalfWidth * kSize, kHalfWidth * kSize)) > 1e-5 * kSize;
        }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(inBand, 5000);
    const auto fog = openvdb::gridConstPtrCast<openvdb::FloatGrid>(made.volume.grids().all[2]);
    EXPECT_EQ(fog->activeVoxelCount(), mask->activeVoxelCount());
  }
}

TEST(ShellSurface, Refuses) {
  const auto statusOf = [](const TriangleMesh& mesh, double thickness) {
    try {
      surfaceOf(mesh, ShellSide::Inward, thickness);
    } catch (const Error& error) {
      return error.status();
    }
    return Status::Ok;
  };
  const TriangleMesh cube = meshes::box({0, 0, 0}, {9, 9, 9});
  EXPECT_EQ(statusOf(cube, 1), Status::Ok);
  EXPECT_EQ(statusOf(cube, 60), Status::Usage);
  EXPECT_EQ(statusOf(meshes::without(cube, [](std::size_t f) { return f == 0; }), 1),
            Status::Invalid);
}

} // namespace
} // namespace tetvdb
