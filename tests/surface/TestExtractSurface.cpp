// SPDX-License-Identifier: Apache-2.0
#include "ManifoldCheck.h"
#include "TriangleMeshes.h"
#include "tetvdb/geometry/BoundaryWinding.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CompareMeshes.h"
#include "tetvdb/surface/CubeTable.h"
#include "tetvdb/surface/ExtractSurface.h"
#include "tetvdb/surface/SolidSamples.h"
#include "tetvdb/surface/TriangleScene.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/SoupBoundary.h"
#include "tetvdb/voxelize/SoupChain.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <tbb/task_arena.h>

using namespace tetvdb;
using namespace tetvdb::meshes;

namespace {

Volume volumeOf(const openvdb::GridBase::Ptr& grid, const GridTransform& transform = {}) {
  grid->setTransform(makeTransform(transform));
  auto grids = std::make_shared<GridSet>();
  grids->all.push_back(grid);
  return Volume(grids);
}

template <class GridT>
std::shared_ptr<GridT> newGrid(const std::string& name, typename GridT::ValueType background) {
  initializeOpenVDB();
  auto grid = GridT::create(background);
  grid->setName(name);
  return grid;
}

// Voxels of a box for which inside(x, y, z) holds.
template <class Inside>
openvdb::BoolGrid::Ptr maskOf(const Vec3i& low, const Vec3i& high, const Inside& inside) {
  auto grid = newGrid<openvdb::BoolGrid>("mask", false);
  auto accessor = grid->getAccessor();
  for (int x = low[0]; x < high[0]; ++x)
    for (int y = low[1]; y < high[1]; ++y)
      for (int z = low[2]; z < high[2]; ++z)
        if (inside(x, y, z))
          accessor.setValueOn({x, y, z}, true);
  return grid;
}

openvdb::FloatGrid::Ptr levelSetOf(double radius, const Vec3d& centre) {
  auto grid = newGrid<openvdb::FloatGrid>("surface", 3.0f);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  auto accessor = grid->getAccessor();
  const int reach = static_cast<int>(radius) + 6;
  for (int x = -reach; x <= reach; ++x)
    for (int y = -reach; y <= reach; ++y)
      for (int z = -reach; z <= reach; ++z) {
        const double d = std::hypot(x - centre[0], y - centre[1], z - centre[2]) - radius;
        if (std::abs(d) < 3)
          accessor.setValueOn({x, y, z}, static_cast<float>(d));
        else if (d < 0)
          accessor.setValueOff({x, y, z}, -3.0f);
      }
  grid->pruneGrid();
  return grid;
}

TriangleMesh extract(const Volume& volume, double simplify = 0,
                     const TriangleScene* original = nullptr, const std::string& grid = "") {
  Progress progress;
  ExtractOptions options;
  options.grid = grid;
  options.simplify = simplify;
  options.original = original;
  return extractSurface(volume, options, progress);
}

std::string messageOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

} // namespace

TEST(CubeTable, ChordsNeverLieInAFaceOfTheCube) {
  // Corners of the cube that an edge joins, as coordinates doubled.
  const auto midpoint = [](int edge) {
    Vec3i p = cubeEdgeStart(edge);
    for (int& c : p)
      c *= 2;
    ++p[static_cast<std::size_t>(edge / 4)];
    return p;
  };
  for (std::size_t inside = 0; inside < 256; ++inside) {
    const CubeTriangles& triangles = cubeTable()[inside];
    std::map<std::pair<int, int>, int> sides;
    std::set<int> edges;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const int a = triangles[i], b = triangles[i % 3 == 2 ? i - 2 : i + 1];
      EXPECT_EQ((++sides[{a, b}]), 1);
      edges.insert(a);
    }
    for (const auto& [side, count] : sides) {
      const bool onBorder = sides.count({side.second, side.first}) == 0;
      const Vec3i p = midpoint(side.first), q = midpoint(side.second);
      bool shareFace = false;
      for (std::size_t axis = 0; axis < 3; ++axis)
        shareFace = shareFace || (p[axis] == q[axis] && p[axis] != 1);
      EXPECT_EQ(onBorder, shareFace) << "case " << inside;
    }
    for (int edge = 0; edge < 12; ++edge) {
      const Vec3i p = cubeEdgeStart(edge);
      const int corner = p[0] + 2 * p[1] + 4 * p[2], other = corner + (1 << edge / 4);
      EXPECT_EQ((inside >> corner & 1) != (inside >> other & 1), edges.count(edge) == 1);
    }
  }
}

TEST(ExtractSurface, EveryCubeCaseIsManifold) {
  for (unsigned inside = 1; inside < 256; ++inside) {
    const TriangleMesh mesh =
        extract(volumeOf(maskOf({6, 6, 6}, {8, 8, 8}, [&](int x, int y, int z) {
          return inside >> ((x - 6) + 2 * (y - 6) + 4 * (z - 6)) & 1;
        })));
    ASSERT_EQ(manifoldDefect(mesh), "") << inside;
    ASSERT_GT(signedVolume(mesh), 0) << inside;
  }
}

TEST(ExtractSurface, RandomBitsAreManifold) {
  Random random(1);
  for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9})
    for (int round = 0; round < 4; ++round) {
      const Volume volume = volumeOf(
          maskOf({-9, -5, -3}, {9, 12, 10}, [&](int, int, int) { return random.unit() < share; }));
      const TriangleMesh mesh = extract(volume);
      ASSERT_EQ(manifoldDefect(mesh), "");
      // Midway between a voxel in and one out: no voxel is far from its own surface.
      ASSERT_EQ(manifoldDefect(extract(volume, 0.3)), "");
    }
}

TEST(ExtractSurface, RandomHeightsAreManifold) {
  Random random(2);
  for (int round = 0; round < 6; ++round) {
    auto grid = newGrid<openvdb::FloatGrid>("density", 0.0f);
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    auto accessor = grid->getAccessor();
    for (int x = 0; x < 17; ++x)
      for (int y = 0; y < 17; ++y)
        for (int z = 0; z < 17; ++z)
          accessor.setValueOn({x, y, z}, round % 2 == 0
                                             ? static_cast<float>(random.unit())
                                             : static_cast<float>(random.below(3)) * 0.5f);
    const Volume volume = volumeOf(grid);
    ASSERT_EQ(manifoldDefect(extract(volume)), "");
    ASSERT_EQ(manifoldDefect(extract(volume, 0.1)), "");
  }
}

TEST(ExtractSurface, OneVoxelIsAnOctahedron) {
  const TriangleMesh mesh =
      extract(volumeOf(maskOf({-1, -1, -1}, {0, 0, 0}, [](int, int, int) { return true; }),
                       {{2, 2, 2}, {10, 20, 30}}));
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_EQ(mesh.points.size(), 6u);
  EXPECT_EQ(mesh.triangleCount(), 8u);
  EXPECT_NEAR(signedVolume(mesh), 4.0 / 3, 1e-12);
  for (const Vec3d& p : mesh.points) {
    const Vec3d centre{8, 18, 28};
    EXPECT_NEAR(std::abs(p[0] - centre[0]) + std::abs(p[1] - centre[1]) +
                    std::abs(p[2] - centre[2]),
                1, 1e-12);
  }
}

TEST(ExtractSurface, LevelSetSpheresConvergeInVolume) {
  double last = 1;
  for (const double radius : {6.0, 12.0, 24.0}) {
    const TriangleMesh mesh = extract(volumeOf(levelSetOf(radius, {0.3, -0.2, 0.1})));
    EXPECT_EQ(manifoldDefect(mesh), "");
    EXPECT_EQ(eulerCharacteristic(mesh), 2);
    for (const Vec3d& p : mesh.points)
      EXPECT_NEAR(std::hypot(p[0] - 0.3, p[1] + 0.2, p[2] - 0.1), radius, 0.06);
    const double off = std::abs(signedVolume(mesh) / (4 * kPi / 3 * std::pow(radius, 3)) - 1);
    EXPECT_LT(off, last / 3); // of second order
    last = off;
  }
  EXPECT_LT(last, 2e-3);
}

// Judged by solid angles.
TEST(ExtractSurface, HolesAreClosedWhereTheWindingNumberIsOneHalf) {
  const TriangleMesh ball =
      moved(sphere({0, 0, 0}, 1, 12), [](const Vec3d& p) { return times(p, 11.3); });
  const TriangleMesh open =
      without(ball, [&](std::size_t f) { return ball.points[ball.triangles[3 * f]][2] > 4; });
  const auto mask = maskOf({-13, -13, -13}, {13, 13, 13}, [&](int x, int y, int z) {
    return windingNumberAt(open, {double(x), double(y), double(z)}) > 0.5;
  });
  Progress progress;
  const GridTransform transform;
  const BoundaryWinding boundary = boundaryWinding(soupBoundary(open, progress).edges,
                                                   snapPoints(open.points, transform, progress));
  const TriangleScene scene(open);
  const auto furthest = [&](const BoundaryWinding* winding) {
    ExtractOptions options;
    options.simplify = 0;
    options.original = &scene;
    options.boundary = winding;
    const TriangleMesh mesh = extractSurface(volumeOf(mask, transform), options, progress);
    EXPECT_EQ(manifoldDefect(mesh), "");
    double largest = 0;
    int inHole = 0;
    for (const Vec3d& p : mesh.points)
      if (!scene.isWithin(p, 2)) {
        ++inHole;
        largest = std::max(largest, std::abs(windingNumberAt(open, p) - 0.5));
      }
    EXPECT_GT(inHole, 100);
    return largest;
  };
  EXPECT_LT(furthest(&boundary), 0.01);
  EXPECT_GT(furthest(nullptr), 0.02);
}

TEST(ExtractSurface, AnisotropicVoxelsAndOrigin) {
  const GridTransform transform{{0.5, 1, 2}, {100, -50, 7}};
  const TriangleMesh mesh = extract(volumeOf(levelSetOf(10, {0, 0, 0}), transform));
  EXPECT_EQ(manifoldDefect(mesh), "");
  for (const Vec3d& p : mesh.points)
    EXPECT_NEAR(std::hypot((p[0] - 100) / 0.5, p[1] + 50, (p[2] - 7) / 2), 10, 0.06);
}

TEST(ExtractSurface, TilesHaveSurfaces) {
  // Tiles of 8, 128 and 4096 voxels a side, next to nothing, to each other and to leaves.
  auto grid = newGrid<openvdb::BoolGrid>("mask", false);
  const openvdb::CoordBBox whole({-128, 0, 0}, {-1, 127, 127});
  grid->fill(whole, true);
  grid->fill(openvdb::CoordBBox({0, 0, 0}, {7, 7, 7}), true);
  grid->fill(openvdb::CoordBBox({0, 24, 24}, {9, 35, 31}), true);
  grid->pruneGrid();
  ASSERT_GT(grid->tree().activeTileCount(), 0u);
  const TriangleMesh mesh = extract(volumeOf(grid));
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_EQ(eulerCharacteristic(mesh), 2);
  // The same voxels without a tile.
  auto leaves = grid->deepCopy();
  leaves->tree().voxelizeActiveTiles();
  const TriangleMesh same = extract(volumeOf(leaves));
  EXPECT_EQ(mesh.points, same.points);
  EXPECT_EQ(mesh.triangles, same.triangles);
}

TEST(SolidSamples, RootTilesAreSurroundedByBlocks) {
  auto grid = newGrid<openvdb::MaskGrid>("mask", false);
  grid->tree().root().addTile({0, 0, 0}, true, true);
  const Volume volume = volumeOf(grid);
  Progress progress;
  const std::vector<Vec3i> blocks = solidSamples(volume, "")->blocks(progress);
  // A shell of blocks one block thick, from -8 to 4088 along each axis.
  EXPECT_EQ(blocks.size(), std::size_t(513) * 513 * 513 - std::size_t(511) * 511 * 511);
  EXPECT_TRUE(std::is_sorted(blocks.begin(), blocks.end()));
  EXPECT_EQ(blocks.front(), (Vec3i{-8, -8, -8}));
  EXPECT_EQ(blocks.back(), (Vec3i{4088, 4088, 4088}));
}

TEST(ExtractSurface, InactiveInteriorOfALevelSetIsInside) {
  const openvdb::FloatGrid::Ptr grid = levelSetOf(20, {0, 0, 0});
  const TriangleMesh mesh = extract(volumeOf(grid));
  EXPECT_EQ(eulerCharacteristic(mesh), 2); // one sphere, and not another inside it
}

TEST(ExtractSurface, VerticesLieOnTheOriginal) {
  const TriangleMesh ball = sphere({0.4, 0.1, -0.2}, 9.3, 14);
  const TriangleScene scene(ball);
  const auto mask = maskOf({-12, -12, -12}, {13, 13, 13}, [&](int x, int y, int z) {
    const double r = std::hypot(x - 0.4, y - 0.1, z + 0.2);
    return r < 9 || (r < 9.31 && windingNumberAt(ball, {double(x), double(y), double(z)}) > 0.5);
  });
  const TriangleMesh mesh = extract(volumeOf(mask), 0, &scene);
  EXPECT_EQ(manifoldDefect(mesh), "");
  std::size_t off = 0;
  for (const Vec3d& p : mesh.points) {
    const double distance = scene.closest(p).distance;
    EXPECT_LT(distance, 0.06);
    off += distance > 1e-6;
  }
  EXPECT_LT(off, mesh.points.size() / 5); // those kept off the voxels
  const TriangleMesh midway = extract(volumeOf(mask));
  EXPECT_EQ(mesh.triangles, midway.triangles);
}

TEST(ExtractSurface, FacesThroughVoxelCentresAreMet) {
  // A third is no double: the far sides pass the voxels' centres by a rounding, either way.
  const double h = 1.0 / 3;
  const TriangleMesh cube = box({-2 * h, -2 * h, -2 * h}, {7 * h, 7 * h, 7 * h}, 3);
  const TriangleScene scene(cube);
  const Volume volume = volumeOf(
      maskOf({-2, -2, -2}, {7, 7, 7}, [](int, int, int) { return true; }), {{h, h, h}, {0, 0, 0}});
  for (const Vec3d& p : extract(volume, 0, &scene).points) {
    double min = 1;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const double side : {-2 * h, 7 * h})
        min = std::min(min, std::abs(p[axis] - side));
    EXPECT_LT(min, 0.051 * h);
  }
}

TEST(ExtractSurface, OfOverlappingShellsTheOuterCounts) {
  // Two boxes that overlap: their inner walls must not attract the surface.
  const TriangleMesh both =
      joined({box({0.3, 0.3, 0.3}, {7.4, 9.6, 9.6}), box({7.1, 0.3, 0.3}, {15.6, 9.6, 9.6})});
  const TriangleScene scene(both);
  const TriangleMesh mesh = extract(
      volumeOf(maskOf({1, 1, 1}, {16, 10, 10}, [](int, int, int) { return true; })), 0, &scene);
  EXPECT_EQ(manifoldDefect(mesh), "");
  for (const Vec3d& p : mesh.points)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_GT(p[axis], 0.29);
      EXPECT_LT(p[axis], axis == 0 ? 15.61 : 9.61);
    }
  // One box in another, the outer wall crossed first from outside.
  const TriangleMesh nested =
      joined({box({0.8, 0.8, 0.8}, {8.2, 8.2, 8.2}), box({0.6, 0.6, 0.6}, {8.4, 8.4, 8.4})});
  const TriangleScene nestedScene(nested);
  for (const Vec3d& p :
       extract(volumeOf(maskOf({1, 1, 1}, {9, 9, 9}, [](int, int, int) { return true; })), 0,
               &nestedScene)
           .points)
    for (const double c : p)
      EXPECT_TRUE(std::abs(c - 0.6) < 1e-6 || std::abs(c - 8.4) < 1e-6 ||
                  std::abs(2 * c - std::round(2 * c)) < 1e-6) // midway along a crease
          << c;
}

TEST(ExtractSurface, SimplifyingKeepsItsPromise) {
  for (const double limit : {0.1, 0.3, 1.0}) {
    const Volume volume = volumeOf(levelSetOf(30, {0.3, 0.4, 0.5}));
    const TriangleMesh fine = extract(volume), coarse = extract(volume, limit);
    EXPECT_EQ(manifoldDefect(coarse), "");
    EXPECT_EQ(eulerCharacteristic(coarse), 2);
    EXPECT_LT(coarse.triangleCount(), fine.triangleCount() / 8);
    Progress progress;
    EXPECT_LE(compareMeshes(fine, coarse, {}, progress).hausdorff, limit);
  }
}

TEST(ExtractSurface, SimplifyingKeepsAThinSpike) {
  // Planes along a spike say nothing about its tip.
  const Volume volume = volumeOf(maskOf({-6, -6, 0}, {7, 7, 60}, [](int x, int y, int z) {
    return std::hypot(x, y) < 5.0 * (1 - z / 60.0);
  }));
  const TriangleMesh fine = extract(volume), coarse = extract(volume, 0.6);
  EXPECT_EQ(manifoldDefect(coarse), "");
  Progress progress;
  EXPECT_LE(compareMeshes(fine, coarse, {}, progress).hausdorff, 0.6);
}

TEST(ExtractSurface, SimplifyingFlatSidesLeavesFewFaces) {
  const TriangleMesh mesh =
      extract(volumeOf(maskOf({0, 0, 0}, {40, 30, 20}, [](int, int, int) { return true; })), 0.01);
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_LT(mesh.triangleCount(), 200u);
}

TEST(ExtractSurface, IndependentOfThreads) {
  const Volume volume = volumeOf(levelSetOf(45, {0, 0, 0}));
  const auto made = [&](int threads) {
    TriangleMesh mesh;
    tbb::task_arena arena(threads);
    arena.execute([&] { mesh = extract(volume, 0.05); });
    return mesh;
  };
  const TriangleMesh one = made(1), two = made(2);
  EXPECT_EQ(one.points, two.points);
  EXPECT_EQ(one.triangles, two.triangles);
}

TEST(ExtractSurface, FarFromTheOriginFloatsStillDiffer) {
  // Half a voxel is two floats apart here, a twentieth is not.
  Random random(5);
  auto grid = newGrid<openvdb::FloatGrid>("density", 0.0f);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  auto accessor = grid->getAccessor();
  for (int x = 0; x < 12; ++x)
    for (int y = 0; y < 12; ++y)
      for (int z = 0; z < 12; ++z)
        accessor.setValueOn({x, y, z}, static_cast<float>(random.unit()));
  EXPECT_EQ(manifoldDefect(extract(volumeOf(grid, {{1, 1, 1}, {3e6, 3e6, -3e6}}))), "");
  const std::string message = messageOf([&] {
    extract(volumeOf(grid, {{1, 1, 1}, {3e8, 3e8, 3e8}}));
  });
  EXPECT_NE(message.find("far from the origin"), std::string::npos) << message;
}

TEST(ExtractSurface, ValuesThatAreNotFinite) {
  auto grid = newGrid<openvdb::FloatGrid>("density", 0.0f);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  auto accessor = grid->getAccessor();
  const float inf = std::numeric_limits<float>::infinity();
  accessor.setValueOn({0, 0, 0}, inf);
  accessor.setValueOn({1, 0, 0}, std::numeric_limits<float>::quiet_NaN());
  accessor.setValueOn({0, 1, 0}, -inf);
  accessor.setValueOn({0, 0, 1}, 1);
  const TriangleMesh mesh = extract(volumeOf(grid));
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_GT(signedVolume(mesh), 0);
}

TEST(ExtractSurface, RefusesWhatIsNoSolid) {
  const auto empty = newGrid<openvdb::BoolGrid>("mask", false);
  EXPECT_NE(messageOf([&] { extract(volumeOf(empty)); }).find("no inside"), std::string::npos);
  const auto ids = newGrid<openvdb::Int32Grid>("tet_id", -1);
  EXPECT_NE(messageOf([&] { extract(volumeOf(ids)); }).find("tet_id"), std::string::npos);
  EXPECT_NE(messageOf([&] { extract(volumeOf(ids), 0, nullptr, "tet_id"); }).find("int32"),
            std::string::npos);
  EXPECT_NE(messageOf([&] { extract(volumeOf(empty), 0, nullptr, "x"); }).find("no grid 'x'"),
            std::string::npos);
  const auto full = newGrid<openvdb::FloatGrid>("density", 1.0f);
  EXPECT_NE(messageOf([&] { extract(volumeOf(full)); }).find("infinity"), std::string::npos);
  EXPECT_NE(messageOf([&] { extract(volumeOf(empty), -1); }).find("simplify"), std::string::npos);
}
