// SPDX-License-Identifier: Apache-2.0
#include "RationalClipping.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/TouchedFace.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <cstring>
#include <gtest/gtest.h>
#include <memory>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

VoxelizeOptions ruled(VoxelRule rule, double voxel = 1) {
  VoxelizeOptions options;
  options.voxelSize = {voxel, voxel, voxel};
  options.grids = {GridKind::Mask, GridKind::Density};
  options.rule = rule;
  options.allowEmpty = true;
  return options;
}

Voxelization run(const TetMesh& mesh, const VoxelizeOptions& options) {
  Report report;
  Progress progress;
  return voxelize(mesh, options, report, progress);
}

const openvdb::BoolGrid& maskOf(const Voxelization& made) {
  return *openvdb::gridConstPtrCast<openvdb::BoolGrid>(made.volume.grids().all.front());
}

std::uint64_t count(const TetMesh& mesh, VoxelRule rule, double voxel = 1) {
  return maskOf(run(mesh, ruled(rule, voxel))).activeVoxelCount();
}

Vec3d turned(const Vec3d& p) {
  const double c = std::cos(0.37), s = std::sin(0.37);
  const Vec3d q{c * p[0] - s * p[1] + 0.01234, s * p[0] + c * p[1] - 0.04321, p[2] + 0.0031};
  return {q[0], c * q[1] - s * q[2], s * q[1] + c * q[2]};
}

LatticePoint snapped(const Vec3d& p) {
  return {snapToLattice(p[0], 0, 1), snapToLattice(p[1], 0, 1), snapToLattice(p[2], 0, 1)};
}

oracle::Point exact(const LatticePoint& p) {
  const auto whole = [](double c) {
    return oracle::Number(static_cast<long long>(c), kUnitsPerVoxel);
  };
  return {whole(p.x), whole(p.y), whole(p.z)};
}

void expectTouched(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const LatticePoint p[3] = {snapped(a), snapped(b), snapped(c)};
  const std::array<oracle::Point, 3> triangle{exact(p[0]), exact(p[1]), exact(p[2])};
  oracle::Number area = 0; // of the three shadows
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
    const auto side = [&](std::size_t i, std::size_t axis) {
      return oracle::Number(triangle[i][axis] - triangle[0][axis]);
    };
    area += abs(oracle::Number(side(1, u) * side(2, v) - side(1, v) * side(2, u)));
  }
  const TouchedFace face(p[0], p[1], p[2]);
  const auto bits = std::make_unique<SlabBits>();
  for (int x0 = -8; x0 < 8; x0 += kLeafSize) {
    std::memset(bits.get(), 0, sizeof *bits);
    face.rasterize(x0, -64, -64, *bits);
    for (int x = 0; x < kLeafSize; ++x)
      for (int y = -8; y < 8; ++y)
        for (int z = -8; z < 8; ++z) {
          const bool is =
              (bits->rows[x * kNodeSize + y + 64][(z + 64) >> 6] >> ((z + 64) & 63) & 1) != 0;
          ASSERT_EQ(is, area > 0 && oracle::passesThrough(triangle, {x0 + x, y, z}))
              << x0 + x << ' ' << y << ' ' << z << " of " << a[0] << ' ' << a[1] << ' ' << a[2]
              << ", " << b[0] << ' ' << b[1] << ' ' << b[2] << ", " << c[0] << ' ' << c[1] << ' '
              << c[2];
        }
  }
}

TEST(TouchedFace, RandomTriangles) {
  meshes::Random random(1);
  const auto point = [&](double size) {
    return Vec3d{random.between(-size, size), random.between(-size, size),
                 random.between(-size, size)};
  };
  for (int i = 0; i < 6; ++i)
    expectTouched(point(5), point(5), point(5));
  for (int i = 0; i < 6; ++i) { // slivers, and smaller than a voxel
    const Vec3d a = point(4), b = point(4);
    expectTouched(a, b, {(a[0] + b[0]) / 2 + 1e-5, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2});
    expectTouched(a, {a[0] + 0.3, a[1], a[2] - 0.2}, {a[0], a[1] + 0.1, a[2]});
  }
}

// Corners, edges and sides of cubes in plenty: halves of voxels.
TEST(TouchedFace, TrianglesThatTouchCubes) {
  meshes::Random random(2);
  const auto half = [&] { return static_cast<double>(random.below(13)) / 2 - 3; };
  for (int i = 0; i < 16; ++i)
    expectTouched({half(), half(), half()}, {half(), half(), half()}, {half(), half(), half()});
  expectTouched({-1.5, -1.5, 0.5}, {2.5, -1.5, 0.5}, {0.5, 2.5, 0.5}); // between cubes
  expectTouched({-1.5, -1.5, 0.25}, {2.5, -1.5, 0.25}, {0.5, 2.5, 0.25});
  expectTouched({1, 1, 1}, {2, 2, 2}, {3, 3, 3}); // no area
  expectTouched({1, 1, 1}, {1, 1, 1}, {1, 1, 1});
}

// The triangle's numbers do not fit 64 bits.
TEST(TouchedFace, WideTriangle) {
  expectTouched({-4000.3, 3.1, -1.7}, {3000.2, -2999.5, 1000.1}, {2000.7, 4100.2, -2001.3});
}

TEST(VoxelRule, BoxesAlongTheAxes) {
  const TetMesh box = meshes::kuhnGrid(4, 3, 2);
  EXPECT_EQ(count(box, VoxelRule::Any), 5u * 4 * 3);
  EXPECT_EQ(count(box, VoxelRule::Centre), 4u * 3 * 2);
  EXPECT_EQ(count(box, VoxelRule::All), 3u * 2 * 1);
  // Sides between cubes belong to none of them.
  const TetMesh aligned = meshes::scaled(box, 1, {0.5, 0.5, 0.5});
  for (const VoxelRule rule : {VoxelRule::Any, VoxelRule::Centre, VoxelRule::All})
    EXPECT_EQ(count(aligned, rule), 24u);
}

TEST(VoxelRule, FullNodes) {
  // Sides a quarter of a voxel beyond cubes, in the next nodes.
  const TetMesh cube = meshes::scaled(meshes::kuhnGrid(2, 2, 2), 128.25, {-128.5, -0.75, 127.5});
  EXPECT_EQ(count(cube, VoxelRule::All), 256u * 256 * 256);
  EXPECT_EQ(count(cube, VoxelRule::Any), 257u * 258 * 257);
  // Nodes full of centres that a side passes through.
  const TetMesh large = meshes::scaled(meshes::kuhnGrid(1, 1, 1), 383.4, {-0.2, -0.2, -0.2});
  EXPECT_EQ(count(large, VoxelRule::Centre), 384u * 384 * 384);
  EXPECT_EQ(count(large, VoxelRule::All), 382u * 382 * 382);
  EXPECT_EQ(count(large, VoxelRule::Any), 384u * 384 * 384);
}

// Thinner than a voxel, between the centres.
TEST(VoxelRule, ThinPlate) {
  const TetMesh plate = meshes::mapped(meshes::kuhnGrid(5, 5, 1), [](const Vec3d& p) {
    return Vec3d{p[0], p[1], p[2] / 8 + 3.25};
  });
  EXPECT_EQ(count(plate, VoxelRule::Any), 36u);
  EXPECT_EQ(count(plate, VoxelRule::Centre), 0u);
  EXPECT_EQ(count(plate, VoxelRule::All), 0u);
}

void expectByShares(const TetMesh& mesh) {
  const auto shares = oracle::filled(mesh);
  const Voxelization any = run(mesh, ruled(VoxelRule::Any)), all = run(mesh, ruled(VoxelRule::All));
  std::uint64_t full = 0;
  for (const auto& [voxel, share] : shares) {
    const openvdb::Coord at(voxel[0], voxel[1], voxel[2]);
    EXPECT_TRUE(maskOf(any).tree().isValueOn(at)) << at;
    EXPECT_EQ(maskOf(all).tree().isValueOn(at), share == 1) << at << ' ' << share;
    full += share == 1;
  }
  EXPECT_EQ(maskOf(any).activeVoxelCount(), shares.size());
  EXPECT_EQ(maskOf(all).activeVoxelCount(), full);
  // Density has the same voxels.
  const auto density = openvdb::gridConstPtrCast<openvdb::FloatGrid>(any.volume.grids().all.back());
  EXPECT_EQ(density->activeVoxelCount(), shares.size());
}

TEST(VoxelRule, ByExactShares) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u})
    expectByShares(meshes::rounded(meshes::soup(1, 0, 4, seed), 1.0 / 16));
  for (const double step : {0.5, 1.0 / 16})
    expectByShares(meshes::rounded(
        meshes::scaled(meshes::jittered(meshes::kuhnGrid(2, 2, 2), 0.2, 9, true), 1.9), step));
}

TEST(VoxelRule, SameForAnyOrderAndThreads) {
  const TetMesh mesh =
      meshes::mapped(meshes::jittered(meshes::kuhnGrid(6, 5, 7), 0.2, 3, true), turned);
  for (const VoxelRule rule : {VoxelRule::Any, VoxelRule::All}) {
    const std::string once = hash(run(mesh, ruled(rule, 0.03)).volume);
    EXPECT_EQ(hash(run(meshes::shuffled(mesh, 5), ruled(rule, 0.03)).volume), once);
    tbb::task_arena one(1), many(7);
    EXPECT_EQ(one.execute([&] { return hash(run(mesh, ruled(rule, 0.03)).volume); }), once);
    EXPECT_EQ(many.execute([&] { return hash(run(mesh, ruled(rule, 0.03)).volume); }), once);
  }
}

TEST(VoxelRule, Triangles) {
  Report report;
  Progress progress;
  const auto counted = [&](const TriangleMesh& mesh, VoxelRule rule) {
    return maskOf(voxelize(mesh, {}, ruled(rule), report, progress)).activeVoxelCount();
  };
  const TriangleMesh hollow = meshes::joined(
      {meshes::box({0, 0, 0}, {9, 9, 9}), meshes::flipped(meshes::box({3, 3, 3}, {6, 6, 6}))});
  EXPECT_EQ(counted(hollow, VoxelRule::Any), 10u * 10 * 10 - 2 * 2 * 2);
  EXPECT_EQ(counted(hollow, VoxelRule::All), 8u * 8 * 8 - 4 * 4 * 4);
}

TEST(VoxelRule, RefusesOwners) {
  const auto status = [](VoxelizeOptions options) {
    try {
      run(meshes::kuhnGrid(2, 2, 2), options);
    } catch (const Error& error) {
      return error.status();
    }
    return Status::Ok;
  };
  VoxelizeOptions options = ruled(VoxelRule::Any);
  options.grids = {GridKind::TetId};
  EXPECT_EQ(status(options), Status::Usage);
  options = ruled(VoxelRule::All);
  options.path = OccupancyPath::Tets;
  EXPECT_EQ(status(options), Status::Usage);
  options = ruled(VoxelRule::All);
  options.allowEmpty = false; // no cube lies in it
  EXPECT_EQ(status(options), Status::Ok);
  options.voxelSize = {4, 4, 4};
  EXPECT_EQ(status(options), Status::Invalid);
}

} // namespace
} // namespace tetvdb
