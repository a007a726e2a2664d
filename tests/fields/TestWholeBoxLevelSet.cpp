// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "fields/BruteDistance.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/fields/WholeBoxLevelSet.h"

#include <cmath>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

struct MadeInBox {
  openvdb::BoolGrid::Ptr mask;
  openvdb::FloatGrid::Ptr surface;
};

MadeInBox make(const TriangleMesh& mesh, double voxel, const ShapeOptions& shapes,
               const SolidOptions& solid = {}) {
  Report report;
  Progress progress;
  VoxelizeOptions options;
  options.voxelSize = {voxel, voxel, voxel};
  options.grids = {GridKind::Mask};
  Voxelization made = voxelize(mesh, solid, options, report, progress);
  addShapeGrids(mesh, solid, shapes, made, report, progress);
  const auto& all = made.volume.grids().all;
  return {openvdb::gridPtrCast<openvdb::BoolGrid>(all.front()),
          openvdb::gridPtrCast<openvdb::FloatGrid>(all.back())};
}

ShapeOptions wholeBox() {
  ShapeOptions shapes;
  shapes.grids = {GridKind::Surface};
  shapes.halfWidth = kWholeBox;
  return shapes;
}

// A bumpy ball about (0.1, 0.2, 0.3) of radius about 1.
TriangleMesh bumpyBall() {
  TriangleMesh mesh;
  constexpr int kRings = 20, kAround = 40;
  for (int i = 0; i <= kRings; ++i)
    for (int j = 0; j < (i == 0 || i == kRings ? 1 : kAround); ++j) {
      const double a = kPi * i / kRings, b = 2 * kPi * j / kAround;
      const double r = 1 + 0.2 * std::sin(4 * a) * std::sin(a) * std::cos(3 * b);
      mesh.points.push_back({0.1 + r * std::sin(a) * std::cos(b),
                             0.2 + r * std::sin(a) * std::sin(b), 0.3 + r * std::cos(a)});
    }
  const auto number = [&](int i, int j) {
    const int first = i == 0 ? 0 : i == kRings ? 1 + (kRings - 1) * kAround : 1 + (i - 1) * kAround;
    return static_cast<std::uint32_t>(first + (i == 0 || i == kRings ? 0 : j % kAround));
  };
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kAround; ++j) {
      const std::uint32_t p = number(i, j), q = number(i, j + 1), r = number(i + 1, j),
                          s = number(i + 1, j + 1);
      if (r != s)
        mesh.triangles.insert(mesh.triangles.end(), {p, r, s});
      if (p != q)
        mesh.triangles.insert(mesh.triangles.end(), {p, s, q});
    }
  return mesh;
}

TEST(WholeBoxLevelSet, EveryVoxelOfTheBoxIsRight) {
  const TriangleMesh mesh = bumpyBall();
  constexpr double kVoxel = 0.17;
  const MadeInBox made = make(mesh, kVoxel, wholeBox());
  const openvdb::CoordBBox box = made.surface->evalActiveVoxelBoundingBox();
  EXPECT_EQ(made.surface->activeVoxelCount(), box.volume());
  openvdb::CoordBBox min = made.mask->evalActiveVoxelBoundingBox();
  min.expand(3);
  EXPECT_TRUE(box.isInside(min));
  EXPECT_EQ(made.surface->getGridClass(), openvdb::GRID_LEVEL_SET);

  const auto surface = made.surface->getConstAccessor();
  const auto mask = made.mask->getConstAccessor();
  int wrong = 0;
  float largest = 0;
  for (auto at = box.begin(); at; ++at) {
    const float value = surface.getValue(*at);
    largest = std::max(largest, std::abs(value));
    const long double truth = oracle::distanceToAll(
        {(*at).x() * kVoxel, (*at).y() * kVoxel, (*at).z() * kVoxel}, mesh.points, mesh.triangles);
    const bool right = (value < 0) == mask.isValueOn(*at) &&
                       std::abs(std::abs(value) - static_cast<double>(truth)) <= 1e-5 * kVoxel;
    if (!right && ++wrong < 5)
      ADD_FAILURE() << *at << ": " << value << ", not " << static_cast<double>(truth);
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(made.surface->background(), largest);
  EXPECT_EQ(surface.getValue(box.max().offsetBy(1)), largest);
}

TEST(WholeBoxLevelSet, AGivenBoxThatCutsTheMesh) {
  const TriangleMesh mesh = bumpyBall();
  ShapeOptions shapes = wholeBox();
  shapes.box = VoxelBox{{-3, 1, 2}, {20, 5, 30}};
  const MadeInBox all = make(mesh, 0.11, wholeBox()), part = make(mesh, 0.11, shapes);
  EXPECT_EQ(part.surface->activeVoxelCount(), 24u * 5u * 29u);
  const auto whole = all.surface->getConstAccessor();
  const openvdb::CoordBBox both = all.surface->evalActiveVoxelBoundingBox();
  for (auto voxel = part.surface->cbeginValueOn(); voxel; ++voxel)
    if (both.isInside(voxel.getCoord())) {
      EXPECT_EQ(*voxel, whole.getValue(voxel.getCoord()));
    }
}

TEST(WholeBoxLevelSet, AgreesWithTheNarrowBandOfAnOpenMesh) {
  TriangleMesh mesh = bumpyBall();
  mesh.triangles.resize(mesh.triangles.size() - 3 * 40); // open at its lower end
  ShapeOptions narrow = wholeBox();
  narrow.halfWidth = 3;
  const MadeInBox band = make(mesh, 0.11, narrow), all = make(mesh, 0.11, wholeBox());
  const auto whole = all.surface->getConstAccessor();
  int compared = 0;
  for (auto voxel = band.surface->cbeginValueOn(); voxel; ++voxel, ++compared)
    ASSERT_NEAR(*voxel, whole.getValue(voxel.getCoord()), 2e-5 * 0.11) << voxel.getCoord();
  EXPECT_GT(compared, 5000);
}

TEST(WholeBoxLevelSet, AShellAroundASheet) {
  TriangleMesh mesh;
  mesh.points = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  mesh.triangles = {0, 1, 2, 0, 2, 3};
  SolidOptions solid;
  solid.shell = 1;
  const MadeInBox made = make(mesh, 0.25, wholeBox(), solid);
  const auto surface = made.surface->getConstAccessor();
  EXPECT_NEAR(surface.getValue({8, 8, 0}), -0.5, 1e-6);
  EXPECT_NEAR(surface.getValue({8, 8, 4}), 0.5, 1e-6);
  EXPECT_NEAR(surface.getValue({-3, -4, 0}), 0.75, 1e-6);
}

TEST(WholeBoxLevelSet, SameForAnyNumberOfThreads) {
  const TriangleMesh mesh = bumpyBall();
  std::string first;
  for (const int threads : {1, 2, 7}) {
    tbb::task_arena arena(threads);
    std::string found;
    arena.execute([&] {
      auto set = std::make_shared<GridSet>();
      set->all = {make(mesh, 0.07, wholeBox()).surface};
      found = hash(Volume(set));
    });
    if (first.empty())
      first = found;
    EXPECT_EQ(found, first);
  }
}

TEST(WholeBoxLevelSet, FogNeedsANumber) {
  ShapeOptions shapes = wholeBox();
  shapes.grids = {GridKind::Fog};
  EXPECT_THROW(checkShapes(shapes, {1, 1, 1}), Error);
}

} // namespace
} // namespace tetvdb
