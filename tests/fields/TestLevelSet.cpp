// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "fields/BruteDistance.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/fields/DistanceBand.h"
#include "tetvdb/fields/LevelSet.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <openvdb/tools/Diagnostics.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

VoxelizeOptions maskOf(double voxel) {
  VoxelizeOptions options;
  options.voxelSize = {voxel, voxel, voxel};
  options.grids = {GridKind::Mask};
  return options;
}

ShapeOptions surfaceOf(double halfWidth) {
  ShapeOptions shapes;
  shapes.grids = {GridKind::Surface};
  shapes.halfWidth = halfWidth;
  return shapes;
}

struct Made {
  Voxelization all;
  openvdb::BoolGrid::Ptr mask;
  openvdb::FloatGrid::Ptr surface;

  explicit Made(Voxelization made) : all(std::move(made)) {
    mask = openvdb::gridPtrCast<openvdb::BoolGrid>(all.volume.grids().all.front());
    surface = openvdb::gridPtrCast<openvdb::FloatGrid>(all.volume.grids().all.back());
  }
};

Made make(const TetMesh& mesh, double voxel, double halfWidth = 3) {
  Report report;
  Progress progress;
  Voxelization made = voxelize(mesh, maskOf(voxel), report, progress);
  addShapeGrids(mesh, surfaceOf(halfWidth), made, report, progress);
  return Made(std::move(made));
}

Made make(const TriangleMesh& mesh, const SolidOptions& solid, double voxel, double halfWidth = 3) {
  Report report;
  Progress progress;
  Voxelization made = voxelize(mesh, solid, maskOf(voxel), report, progress);
  addShapeGrids(mesh, solid, surfaceOf(halfWidth), made, report, progress);
  return Made(std::move(made));
}

// Turned about two axes and moved: no face along an axis.
Vec3d turned(const Vec3d& p) {
  const double c = std::cos(0.37), s = std::sin(0.37);
  const Vec3d q{c * p[0] - s * p[1] + 0.01234, s * p[0] + c * p[1] - 0.04321, p[2] + 0.0031};
  return {q[0], c * q[1] - s * q[2], s * q[1] + c * q[2]};
}
Vec3d turnedBack(const Vec3d& p) {
  const double c = std::cos(0.37), s = std::sin(0.37);
  const Vec3d q{p[0], c * p[1] + s * p[2], c * p[2] - s * p[1]};
  const Vec3d r{q[0] - 0.01234, q[1] + 0.04321, q[2] - 0.0031};
  return {c * r[0] + s * r[1], c * r[1] - s * r[0], r[2]};
}

// Signed distance to the box [0, size]^3.
double boxDistance(const Vec3d& p, double size) {
  double outside = 0, inside = -size;
  for (const double c : p) {
    const double beyond = std::abs(c - size / 2) - size / 2;
    outside += std::max(beyond, 0.0) * std::max(beyond, 0.0);
    inside = std::max(inside, beyond);
  }
  return outside > 0 ? std::sqrt(outside) : inside;
}

// Every voxel of the active box, grown by two, against signed distances in world units.
void expectDistances(const Made& made, double voxel, double halfWidth,
                     const std::function<double(const Vec3d&)>& truth) {
  const auto surface = made.surface->getConstAccessor();
  const auto mask = made.mask->getConstAccessor();
  const double tolerance = voxel * (kDistanceError + 1e-6), band = halfWidth * voxel;
  EXPECT_NEAR(made.surface->background(), band, band * 1e-7);
  openvdb::CoordBBox box = made.surface->evalActiveVoxelBoundingBox();
  box.expand(2);
  int wrong = 0;
  for (auto at = box.begin(); at; ++at) {
    const double d = truth({(*at).x() * voxel, (*at).y() * voxel, (*at).z() * voxel});
    const double value = surface.getValue(*at);
    const bool inside = mask.isValueOn(*at);
    bool right = (value < 0) == inside;
    if (std::abs(d) > tolerance)
      right = right && (d < 0) == inside;
    const double expected = std::min(std::abs(d), band);
    right = right && std::abs(std::abs(value) - expected) <= tolerance;
    if (surface.isValueOn(*at))
      right = right && std::abs(d) <= band + tolerance;
    else
      right = right && std::abs(d) >= band - tolerance &&
              std::abs(value) == double(made.surface->background());
    if (!right && ++wrong < 5)
      ADD_FAILURE() << *at << ": " << value << (inside ? " inside, " : " outside, ") << "expected "
                    << d;
  }
  EXPECT_EQ(wrong, 0);
}

void expectValid(const openvdb::FloatGrid& grid, std::size_t checks = 9) {
  EXPECT_EQ(openvdb::tools::checkLevelSet(grid, checks), "");
  EXPECT_EQ(grid.getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(grid.getName(), "surface");
}

TEST(LevelSet, BoxAlongTheAxes) {
  const Made made = make(meshes::scaled(meshes::kuhnGrid(2, 3, 2), 0.5), 0.0371);
  expectValid(*made.surface, 8); // at edges no gradient has length one
  TetMesh cube = meshes::kuhnGrid(3, 3, 3);
  expectDistances(make(cube, 0.13, 3), 0.13, 3, [](const Vec3d& p) { return boxDistance(p, 3); });
}

TEST(LevelSet, TurnedBoxAtSeveralHalfWidths) {
  const TetMesh cube = meshes::mapped(meshes::kuhnGrid(2, 2, 2), turned);
  for (const double halfWidth : {1.0, 1.5, 3.0, 6.25}) {
    const Made made = make(cube, 0.07, halfWidth);
    if (halfWidth >= 3)
      expectValid(*made.surface, 8);
    expectDistances(made, 0.07, halfWidth,
                    [](const Vec3d& p) { return boxDistance(turnedBack(p), 2); });
  }
}

// Faces of several nodes, edges of 380 voxels.
TEST(LevelSet, LargeFacesAgainstTheBox) {
  const TetMesh cube = meshes::mapped(meshes::kuhnGrid(1, 1, 1), turned);
  const double voxel = 1.0 / 270;
  const Made made = make(cube, voxel);
  expectValid(*made.surface, 8);
  int wrong = 0;
  std::uint64_t seen = 0;
  for (auto v = made.surface->cbeginValueOn(); v; ++v, ++seen) {
    const auto c = v.getCoord();
    const double d = boxDistance(turnedBack({c.x() * voxel, c.y() * voxel, c.z() * voxel}), 1);
    wrong +=
        std::abs(*v - d) > voxel * (kDistanceError + 1e-6) && std::abs(d) > voxel * kDistanceError;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_NEAR(double(seen), 6 * 270 * 270 * 6, 0.05 * 6 * 270 * 270 * 6);
  // Far inside and far outside there are tiles.
  const auto inTheMiddle =
      openvdb::Coord::round(openvdb::Vec3d(turned({0.5, 0.5, 0.5}).data()) / voxel);
  EXPECT_EQ(made.surface->tree().getValue(inTheMiddle), -made.surface->background());
  EXPECT_EQ(made.surface->tree().probeConstLeaf(inTheMiddle), nullptr);
  EXPECT_EQ(made.surface->tree().getValue(openvdb::Coord(3000, 0, 0)), made.surface->background());
}

// Inside tiles of 128^3 and above, and their neighbours.
TEST(LevelSet, FullNodesAreNegativeTiles) {
  const TetMesh cube = meshes::scaled(meshes::kuhnGrid(1, 1, 1), 700, {0.3, 0.2, 0.1});
  const Made made = make(cube, 1);
  EXPECT_EQ(made.surface->tree().activeTileCount(), 0u);
  const auto mask = made.mask->getConstAccessor();
  const auto surface = made.surface->getConstAccessor();
  meshes::Random random(7);
  for (int i = 0; i < 20000; ++i) {
    const openvdb::Coord c(int(random.between(-140, 840)), int(random.between(-140, 840)),
                           int(random.between(-140, 840)));
    ASSERT_EQ(surface.getValue(c) < 0, mask.isValueOn(c)) << c;
  }
}

// Many small faces to a voxel, against brute force over all of them.
TEST(LevelSet, SmallFacesByBruteForce) {
  const TriangleMesh mesh = meshes::moved(meshes::sphere({0, 0, 0}, 1, 9), turned);
  for (const double voxel : {0.31, 0.15}) {
    const Made made = make(mesh, {}, voxel);
    expectValid(*made.surface, 8);
    const auto mask = made.mask->getConstAccessor();
    expectDistances(made, voxel, 3, [&](const Vec3d& p) {
      const double d =
          double(oracle::distanceToAll({p[0], p[1], p[2]}, mesh.points, mesh.triangles));
      const openvdb::Coord c(int(std::lround(p[0] / voxel)), int(std::lround(p[1] / voxel)),
                             int(std::lround(p[2] / voxel)));
      return mask.isValueOn(c) ? -d : d;
    });
  }
}

// Smooth enough for OpenVDB's check of gradients.
TEST(LevelSet, SphereSatisfiesTheEikonalCheck) {
  const Made made = make(meshes::sphere({0.1, 0.2, 0.3}, 1, 40), {}, 0.04);
  expectValid(*made.surface, 9);
}

// Faces without area are segments and points.
TEST(LevelSet, DegenerateFaces) {
  SnappedMesh mesh;
  const double unit = double(kUnitsPerVoxel);
  const std::vector<Vec3d> points = {{0.3, 0.2, 0.1}, {9.7, 4.2, -3.3}, {5.0, 2.2, -1.6},
                                     {-6, 2, 3},      {20, 20, 20},     {20.5, 31, 20}};
  for (const Vec3d& p : points)
    mesh.points.push_back(
        {std::round(p[0] * unit), std::round(p[1] * unit), std::round(p[2] * unit)});
  mesh.pointCount = points.size();
  mesh.points.push_back({0, 0, 0});
  // On the segment from 0 to 1 exactly.
  mesh.points[2] = {(mesh.points[0].x + mesh.points[1].x) / 2,
                    (mesh.points[0].y + mesh.points[1].y) / 2,
                    (mesh.points[0].z + mesh.points[1].z) / 2};
  mesh.boxMin = {-6 * unit, -4 * unit, -4 * unit};
  mesh.boxMax = {21 * unit, 31 * unit, 20 * unit};
  Boundary faces;
  faces.faces = {{0, 2, 1, 1}, {3, 3, 3, 1}, {4, 5, 5, 1}};
  std::vector<Vec3d> exact;
  for (std::size_t i = 0; i < points.size(); ++i)
    exact.push_back({mesh.points[i].x / unit, mesh.points[i].y / unit, mesh.points[i].z / unit});
  const std::vector<std::uint32_t> triangles = {0, 2, 1, 3, 3, 3, 4, 5, 5};
  Progress progress;
  const auto empty = openvdb::BoolGrid::create(false);
  const auto grid = levelSet(mesh, faces, *empty, GridTransform{}, 4, 0, rasterizeBand, progress);
  std::size_t seen = 0;
  for (int x = -12; x < 28; ++x)
    for (int y = -10; y < 38; ++y)
      for (int z = -10; z < 28; ++z) {
        const double d = double(oracle::distanceToAll(
            {(long double)x, (long double)y, (long double)z}, exact, triangles));
        const double value = grid->tree().getValue({x, y, z});
        ASSERT_NEAR(value, std::min(d, 4.0), kDistanceError) << x << ' ' << y << ' ' << z;
        seen += d < 4;
      }
  EXPECT_NEAR(double(grid->activeVoxelCount()), double(seen), 3);
}

// Voxel centres on the faces: the mask decides, and inside is below zero.
TEST(LevelSet, CentresOnTheSurface) {
  const Made made = make(meshes::kuhnGrid(6, 6, 6), 1);
  std::uint64_t inside = 0;
  for (int x = -2; x < 9; ++x)
    for (int y = -2; y < 9; ++y)
      for (int z = -2; z < 9; ++z)
        inside += made.surface->tree().getValue({x, y, z}) < 0;
  EXPECT_EQ(inside, made.mask->activeVoxelCount());
  EXPECT_EQ(inside, 216u);
  expectValid(*made.surface, 8);
}

TEST(LevelSet, SameForAnyOrderAndThreads) {
  const TetMesh mesh =
      meshes::mapped(meshes::jittered(meshes::kuhnGrid(6, 5, 7), 0.2, 3, true), turned);
  const std::string once = hash(make(mesh, 0.05).all.volume);
  EXPECT_EQ(hash(make(meshes::shuffled(mesh, 5), 0.05).all.volume), once);
  tbb::task_arena one(1), many(7);
  EXPECT_EQ(one.execute([&] { return hash(make(mesh, 0.05).all.volume); }), once);
  EXPECT_EQ(many.execute([&] { return hash(make(mesh, 0.05).all.volume); }), once);
}

// Two neighbours on different sides have a face between them; else no tool can place the surface.
void expectClosed(const Made& made, double voxel) {
  const auto surface = made.surface->getConstAccessor();
  openvdb::CoordBBox box = made.mask->evalActiveVoxelBoundingBox();
  box.expand(2);
  int wrong = 0;
  std::size_t pairs = 0;
  for (auto at = box.begin(); at; ++at)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      openvdb::Coord next = *at;
      ++next[axis];
      const double a = surface.getValue(*at), b = surface.getValue(next);
      if ((a < 0) == (b < 0))
        continue;
      ++pairs;
      if (std::abs(a) + std::abs(b) > voxel * (1 + 1e-3) && ++wrong < 5)
        ADD_FAILURE() << *at << " axis " << axis << ": " << a << ' ' << b;
    }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(pairs, 100u);
}

// The hole is closed where the winding number passes a half.
TEST(LevelSet, OpenBoxIsClosedOverItsHole) {
  const TriangleMesh open =
      meshes::moved(meshes::without(meshes::box({0, 0, 0}, {1, 1, 1}, 4),
                                    [](std::size_t face) { return face < 32; }), // x = 0
                    turned);
  const double voxel = 0.03;
  const Made made = make(open, {}, voxel);
  expectValid(*made.surface, 8);
  expectClosed(made, voxel);
  // Across the hole's middle, against the winding number by solid angles.
  const Vec3d midpoint = turned({0, 0.5, 0.5}), further = turned({1, 0.5, 0.5});
  double low = -0.9, high = 0.9; // outside, inside
  const auto along = [&](double t) {
    return Vec3d{midpoint[0] + t * (further[0] - midpoint[0]),
                 midpoint[1] + t * (further[1] - midpoint[1]),
                 midpoint[2] + t * (further[2] - midpoint[2])};
  };
  while (high - low > 1e-6)
    (meshes::windingNumberAt(open, along((low + high) / 2)) > 0.5 ? high : low) = (low + high) / 2;
  for (const double offset : {-2.0, -1.0, 1.0, 2.0}) {
    const Vec3d p = along(low + offset * voxel);
    const openvdb::Coord c = openvdb::Coord::round(openvdb::Vec3d(p.data()) / voxel);
    const Vec3d centre{c.x() * voxel, c.y() * voxel, c.z() * voxel};
    const Vec3d way{centre[0] - along(low)[0], centre[1] - along(low)[1],
                    centre[2] - along(low)[2]};
    const double ahead = way[0] * (further[0] - midpoint[0]) + way[1] * (further[1] - midpoint[1]) +
                         way[2] * (further[2] - midpoint[2]);
    EXPECT_NEAR(made.surface->tree().getValue(c), -ahead, voxel) << offset;
  }
}

TEST(LevelSet, SheetInsideMakesNoZeroCrossing) {
  TriangleMesh sheet;
  sheet.points = {{0.2, 0.2, 0.5}, {0.8, 0.2, 0.5}, {0.8, 0.8, 0.55}, {0.2, 0.8, 0.5}};
  sheet.triangles = {0, 1, 2, 0, 2, 3};
  const Made made = make(meshes::joined({meshes::box(), sheet}), {}, 0.02);
  std::uint64_t negative = 0;
  for (int x = -3; x < 54; ++x)
    for (int y = -3; y < 54; ++y)
      for (int z = -3; z < 54; ++z)
        negative += made.surface->tree().getValue({x, y, z}) < 0;
  EXPECT_EQ(negative, 50u * 50 * 50);
  expectValid(*made.surface, 8);
}

TEST(LevelSet, ShellIsMeasuredFromItsSurface) {
  const TriangleMesh mesh = meshes::moved(meshes::sphere({0, 0, 0}, 1, 4), turned);
  SolidOptions solid;
  solid.shell = 0.5;
  const double voxel = 0.09;
  const Made made = make(mesh, solid, voxel, 3);
  expectValid(*made.surface, 8);
  expectDistances(made, voxel, 3, [&](const Vec3d& p) {
    return double(oracle::distanceToAll({p[0], p[1], p[2]}, mesh.points, mesh.triangles)) - 0.25;
  });
}

TEST(LevelSet, FogFromTheLevelSet) {
  Report report;
  Progress progress;
  const TetMesh cube = meshes::mapped(meshes::kuhnGrid(2, 2, 2), turned);
  Voxelization made = voxelize(cube, maskOf(0.05), report, progress);
  ShapeOptions shapes;
  shapes.grids = {GridKind::Fog, GridKind::Surface};
  addShapeGrids(cube, shapes, made, report, progress);
  const auto& grids = made.volume.grids().all;
  ASSERT_EQ(grids.size(), 3u);
  const auto fog = openvdb::gridPtrCast<openvdb::FloatGrid>(grids[1]);
  const auto surface = openvdb::gridPtrCast<openvdb::FloatGrid>(grids[2]);
  EXPECT_EQ(fog->getName(), "fog");
  EXPECT_EQ(fog->getGridClass(), openvdb::GRID_FOG_VOLUME);
  EXPECT_EQ(fog->background(), 0);
  for (int x = -3; x < 60; ++x)
    for (int y = -10; y < 60; ++y)
      for (int z = -10; z < 60; z += 7) {
        const double d = surface->tree().getValue({x, y, z});
        ASSERT_NEAR(fog->tree().getValue({x, y, z}), std::clamp(-d / 0.15, 0.0, 1.0), 1e-5);
      }
  EXPECT_EQ(report.stages.back().name, "fields");
}

// Where there is no GPU: Auto says so, and asking for one is an error.
TEST(LevelSet, DeviceThatIsNotThere) {
  const auto isThere = [] {
    try {
      requireDevice({DeviceKind::Cuda, {0}});
    } catch (const Error&) {
      return false;
    }
    return true;
  };
  if (isThere())
    GTEST_SKIP() << "there is a GPU";
  const TetMesh cube = meshes::kuhnGrid(2, 2, 2);
  Report report;
  Progress progress;
  Voxelization made = voxelize(cube, maskOf(0.1), report, progress);
  ShapeOptions shapes = surfaceOf(3);
  shapes.device.kind = DeviceKind::Auto;
  const ShapeSums sums = addShapeGrids(cube, shapes, made, report, progress);
  EXPECT_EQ(sums.device.name, "cpu");
  EXPECT_FALSE(sums.device.why.empty());
  EXPECT_EQ(hash(made.volume), hash(make(cube, 0.1).all.volume));
  shapes.device.kind = DeviceKind::Cuda;
  try {
    addShapeGrids(cube, shapes, made, report, progress);
    FAIL() << "no GPU";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Device);
  }
  EXPECT_TRUE(report.warnings.empty());
}

TEST(LevelSet, RefusesWhatCannotBe) {
  const auto status = [](const auto& f) {
    try {
      f();
    } catch (const Error& error) {
      return error.status();
    }
    return Status::Ok;
  };
  ShapeOptions shapes = surfaceOf(0.5);
  EXPECT_EQ(status([&] { checkShapes(shapes, {1, 1, 1}); }), Status::Usage);
  shapes = surfaceOf(3);
  EXPECT_EQ(status([&] { checkShapes(shapes, {1, 1, 2}); }), Status::Usage);
  EXPECT_EQ(status([&] { checkShapes(shapes, {2, 2, 2}); }), Status::Ok);
  shapes.grids.push_back(GridKind::Surface);
  EXPECT_EQ(status([&] { checkShapes(shapes, {1, 1, 1}); }), Status::Usage);
  EXPECT_EQ(status([] {
              const TetMesh mesh = meshes::kuhnGrid(4, 4, 4);
              Report report;
              Progress progress;
              Voxelization made = voxelize(mesh, maskOf(0.01), report, progress);
              ShapeOptions small = surfaceOf(3);
              small.maxMemory = 1 << 20;
              addShapeGrids(mesh, small, made, report, progress);
            }),
            Status::Limit);
}

} // namespace
} // namespace tetvdb
