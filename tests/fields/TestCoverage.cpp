// SPDX-License-Identifier: Apache-2.0
#include "RationalClipping.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/fields/Coverage.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/surface/TetSurface.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <tbb/task_arena.h>
#include <vector>

namespace tetvdb {
namespace {

struct Made {
  openvdb::FloatGrid::Ptr grid;
  CoverageSum sum;
  Report report;
  Volume volume;
};

template <typename... Mesh>
Made make(const Vec3d& voxel, const Mesh&... mesh) {
  VoxelizeOptions options;
  options.voxelSize = voxel;
  options.grids = {GridKind::Mask};
  options.allowEmpty = true;
  ShapeOptions shapes;
  shapes.grids = {GridKind::Coverage};
  Made made;
  Progress progress;
  Voxelization all = voxelize(mesh..., options, made.report, progress);
  made.sum = addShapeGrids(mesh..., shapes, all, made.report, progress).coverage;
  made.grid = openvdb::gridPtrCast<openvdb::FloatGrid>(all.volume.grids().all.back());
  made.volume = all.volume;
  return made;
}

double sumOf(const openvdb::FloatGrid& grid) {
  long double sum = 0;
  for (auto v = grid.cbeginValueOn(); v; ++v)
    sum += static_cast<long double>(*v) * static_cast<long double>(v.getVoxelCount());
  return static_cast<double>(sum);
}

// In voxels.
double volumeOf(const TetMesh& mesh, const Vec3d& voxel) {
  long double sum = 0;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    std::array<std::array<long double, 3>, 3> e{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        e[i][k] = (static_cast<long double>(mesh.points[mesh.tets[4 * t + i + 1]][k]) -
                   mesh.points[mesh.tets[4 * t]][k]) /
                  voxel[k];
    sum += std::abs(e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                    e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                    e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
           6;
  }
  return static_cast<double>(sum);
}

Vec3d turned(const Vec3d& p) {
  const double c = std::cos(0.37), s = std::sin(0.37);
  const Vec3d q{c * p[0] - s * p[1] + 0.01234, s * p[0] + c * p[1] - 0.04321, p[2] + 0.0031};
  return {q[0], c * q[1] - s * q[2], s * q[1] + c * q[2]};
}

void expectShares(const Made& made, const std::map<std::array<int, 3>, oracle::Number>& shares) {
  int wrong = 0;
  for (const auto& [voxel, exact] : shares) {
    const double share = std::min(exact.convert_to<double>(), 1.0);
    const openvdb::Coord at(voxel[0], voxel[1], voxel[2]);
    const double value = made.grid->tree().getValue(at);
    const bool right = std::abs(value - share) <= kCoverageError + 0x1p-23 * share &&
                       (made.grid->tree().isValueOn(at) || share < kCoverageError);
    if (!right && ++wrong < 5)
      ADD_FAILURE() << at << ": " << value << ", expected " << share;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_LE(made.grid->activeVoxelCount(), shares.size());
}

TEST(Coverage, BoxesAlongTheAxesAreExact) {
  const TetMesh box = meshes::kuhnGrid(4, 3, 2);
  const Made halves = make({1, 1, 1}, box);
  for (int x = 0; x <= 4; ++x)
    for (int y = 0; y <= 3; ++y)
      for (int z = 0; z <= 2; ++z) {
        const float share = (x == 0 || x == 4 ? 0.5f : 1.0f) * (y == 0 || y == 3 ? 0.5f : 1.0f) *
                            (z == 0 || z == 2 ? 0.5f : 1.0f);
        EXPECT_EQ(halves.grid->tree().getValue({x, y, z}), share);
      }
  EXPECT_EQ(halves.grid->activeVoxelCount(), 5u * 4 * 3);
  EXPECT_EQ(sumOf(*halves.grid), 24);
  EXPECT_EQ(halves.grid->getGridClass(), openvdb::GRID_FOG_VOLUME);
  EXPECT_EQ(halves.grid->getName(), "coverage");

  // Faces between cubes: every cube is full or empty.
  const Made whole = make({1, 1, 1}, meshes::scaled(box, 1, {0.5, 0.5, 0.5}));
  EXPECT_EQ(whole.grid->activeVoxelCount(), 24u);
  EXPECT_EQ(sumOf(*whole.grid), 24);
}

TEST(Coverage, FullNodesAreTiles) {
  const TetMesh cube =
      meshes::scaled(meshes::kuhnGrid(2, 2, 2), 128, {-128.5, -0.5, 127.5}); // 256^3 voxels
  const Made made = make({1, 1, 1}, cube);
  EXPECT_EQ(made.grid->tree().leafCount(), 0u);
  EXPECT_EQ(made.grid->tree().activeTileCount(), 8u);
  EXPECT_EQ(made.grid->activeVoxelCount(), 256u * 256 * 256);
}

TEST(Coverage, TetsAgainstRationalClipping) {
  for (const std::uint64_t seed : {1u, 2u, 3u})
    expectShares(make({1, 1, 1}, meshes::rounded(meshes::soup(1, 0, 3, seed), 1.0 / 16)),
                 oracle::filled(meshes::rounded(meshes::soup(1, 0, 3, seed), 1.0 / 16)));
  const TetMesh small = meshes::rounded(
      meshes::scaled(meshes::jittered(meshes::kuhnGrid(2, 2, 2), 0.2, 9, true), 0.9), 1.0 / 16);
  expectShares(make({1, 1, 1}, small), oracle::filled(small));
}

TEST(Coverage, OverlapsCountOnce) {
  const TetMesh soup = meshes::rounded(meshes::soup(40, 1, 2, 5), 1.0 / 16);
  const auto shares = oracle::filled(soup);
  const Made made = make({1, 1, 1}, soup);
  expectShares(made, shares);
  oracle::Number sum = 0, more = 0;
  std::uint64_t voxels = 0;
  for (const auto& [voxel, share] : shares) {
    sum += share < 1 ? share : oracle::Number(1);
    if (share > 1) {
      more += share - 1;
      ++voxels;
    }
  }
  EXPECT_GT(voxels, 5u);
  EXPECT_EQ(made.sum.overlapVoxels, voxels);
  EXPECT_NEAR(made.sum.overlap, more.convert_to<double>(), 1e-9);
  EXPECT_NEAR(made.sum.filled, sum.convert_to<double>(), 1e-9);
  EXPECT_TRUE(std::any_of(made.report.warnings.begin(), made.report.warnings.end(),
                          [](const Warning& w) { return w.code == "overlap"; }));
}

TEST(Coverage, SumIsTheVolume) {
  const TetMesh cube = meshes::mapped(meshes::kuhnGrid(2, 2, 2), turned);
  const TetMesh ball = meshes::ball(8, 1.0, {0.01, 0.02, 0.03});
  for (const TetMesh& mesh : {cube, ball})
    for (const Vec3d& voxel :
         {Vec3d{0.1, 0.1, 0.1}, Vec3d{0.013, 0.013, 0.013}, Vec3d{0.03, 0.02, 0.07}}) {
      const Made made = make(voxel, mesh);
      const double volume = volumeOf(mesh, voxel);
      EXPECT_NEAR(made.sum.filled / volume, 1, 1e-13);
      EXPECT_NEAR(sumOf(*made.grid) / volume, 1, 1e-10);
      EXPECT_EQ(made.sum.overlapVoxels, 0u);
    }
}

// One tet through several nodes along every axis, its faces longer than any of them.
TEST(Coverage, LargeFaces) {
  TetMesh tet;
  tet.points = {
      {-150.3, -20.1, 3.7}, {320.2, 40.9, -70.3}, {10.4, 377.8, 31.4}, {31.7, 88.2, 444.4}};
  tet.tets = {0, 1, 2, 3};
  tet.cellCount = 1;
  const Made made = make({1, 1, 1}, tet);
  EXPECT_NEAR(sumOf(*made.grid) / volumeOf(tet, {1, 1, 1}), 1, 1e-12);
  EXPECT_EQ(made.grid->tree().getValue({50, 100, 100}), 1.0f);
  EXPECT_EQ(made.grid->tree().probeConstLeaf({50, 100, 100}), nullptr);
}

// Thinner than a voxel, between the centres.
TEST(Coverage, ThinPlate) {
  const TetMesh plate = meshes::mapped(meshes::kuhnGrid(5, 5, 1), [](const Vec3d& p) {
    return Vec3d{p[0], p[1], p[2] / 8 + 3.25};
  });
  const Made made = make({1, 1, 1}, plate);
  EXPECT_EQ(made.grid->activeVoxelCount(), 36u);
  EXPECT_EQ(made.grid->tree().getValue({2, 2, 3}), 0.125f);
  EXPECT_EQ(made.grid->tree().getValue({0, 2, 3}), 0.0625f);
}

TEST(Coverage, SameForAnyOrderAndThreads) {
  const TetMesh mesh =
      meshes::mapped(meshes::jittered(meshes::kuhnGrid(6, 5, 7), 0.2, 3, true), turned);
  const Vec3d voxel{0.05, 0.05, 0.05};
  const std::string once = hash(make(voxel, mesh).volume);
  EXPECT_EQ(hash(make(voxel, meshes::shuffled(mesh, 5)).volume), once);
  tbb::task_arena one(1), many(7);
  EXPECT_EQ(one.execute([&] { return hash(make(voxel, mesh).volume); }), once);
  EXPECT_EQ(many.execute([&] { return hash(make(voxel, mesh).volume); }), once);
}

TEST(Coverage, ClosedTriangles) {
  const TetMesh mesh = meshes::mapped(meshes::kuhnGrid(3, 3, 3), turned);
  Progress progress;
  const Vec3d voxel{0.07, 0.07, 0.07};
  EXPECT_EQ(hash(make(voxel, tetSurface(mesh, progress), SolidOptions()).volume),
            hash(make(voxel, mesh).volume));

  // A cavity, and parts that overlap.
  const TriangleMesh hollow = meshes::joined(
      {meshes::box({0, 0, 0}, {4, 4, 4}), meshes::flipped(meshes::box({1, 1, 1}, {2, 2, 2}))});
  EXPECT_NEAR(sumOf(*make({0.3, 0.3, 0.3}, hollow, SolidOptions()).grid) * 0.027, 63, 1e-7);
}

TEST(Coverage, RefusesWhatHasNoVolume) {
  const auto status = [](const TriangleMesh& mesh, const SolidOptions& solid) {
    try {
      make({0.1, 0.1, 0.1}, mesh, solid);
    } catch (const Error& error) {
      return error.status();
    }
    return Status::Ok;
  };
  const TriangleMesh open =
      meshes::without(meshes::box(), [](std::size_t face) { return face < 2; });
  EXPECT_EQ(status(open, {}), Status::Invalid);
  SolidOptions shell;
  shell.shell = 0.2;
  EXPECT_EQ(status(meshes::box(), shell), Status::Usage);
  EXPECT_EQ(status(meshes::box(), {}), Status::Ok);
}

} // namespace
} // namespace tetvdb
