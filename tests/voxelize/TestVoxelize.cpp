// SPDX-License-Identifier: Apache-2.0
#include "DenseOracle.h"
#include "Meshes.h"
#include "TestScale.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <tbb/task_arena.h>

namespace {

using namespace tetvdb;
using meshes::kuhnGrid;

// Voxels of one unit unless told otherwise.
VoxelizeOptions unitVoxels(std::vector<GridKind> grids, OccupancyPath path = OccupancyPath::Auto) {
  VoxelizeOptions options;
  options.voxelSize = {1, 1, 1};
  options.grids = std::move(grids);
  options.path = path;
  options.allowEmpty = true;
  return options;
}

Voxelization run(const TetMesh& mesh, const VoxelizeOptions& options) {
  Report report;
  Progress progress;
  return voxelize(mesh, options, report, progress);
}

std::uint64_t count(const TetMesh& mesh, OccupancyPath path) {
  return run(mesh, unitVoxels({GridKind::Mask}, path)).volume.grids().all[0]->activeVoxelCount();
}

template <typename Grid>
const Grid& grid(const Voxelization& v, std::size_t i = 0) {
  return *openvdb::gridConstPtrCast<Grid>(v.volume.grids().all[i]);
}

// Every voxel of every grid against the oracle.
void expectOracle(const TetMesh& mesh, VoxelizeOptions options) {
  options.grids = {GridKind::Density, GridKind::Mask};
  options.allowEmpty = true;
  for (OccupancyPath path : {OccupancyPath::Boundary, OccupancyPath::Tets}) {
    options.path = path;
    const Voxelization v = run(mesh, options);
    const auto expected = oracle::voxels(mesh, v.transform);
    const auto density = grid<openvdb::FloatGrid>(v).getConstAccessor();
    const auto mask = grid<openvdb::BoolGrid>(v, 1).getConstAccessor();
    ASSERT_EQ(grid<openvdb::FloatGrid>(v).activeVoxelCount(), expected.size());
    ASSERT_EQ(grid<openvdb::BoolGrid>(v, 1).activeVoxelCount(), expected.size());
    for (const auto& [voxel, owner] : expected) {
      const openvdb::Coord c(std::get<0>(voxel), std::get<1>(voxel), std::get<2>(voxel));
      ASSERT_TRUE(mask.isValueOn(c) && mask.getValue(c)) << c;
      ASSERT_TRUE(density.isValueOn(c)) << c;
      ASSERT_EQ(density.getValue(c), 1.0f) << c;
    }
  }
  options.grids = {GridKind::TetId};
  const Voxelization v = run(mesh, options);
  const auto expected = oracle::voxels(mesh, v.transform);
  ASSERT_EQ(grid<openvdb::Int32Grid>(v).activeVoxelCount(), expected.size());
  const auto id = grid<openvdb::Int32Grid>(v).getConstAccessor();
  for (const auto& [voxel, owner] : expected) {
    const openvdb::Coord c(std::get<0>(voxel), std::get<1>(voxel), std::get<2>(voxel));
    ASSERT_EQ(id.getValue(c), static_cast<int>(owner.tet)) << c;
  }
  ASSERT_EQ(id.getValue(openvdb::Coord(-1000)), -1);
}

// Every centre of these is on a face, an edge or a vertex of several tets.
TEST(Voxelize, LatticeWhereEveryCentreIsATie) {
  for (int cell : {1, 2, 3, 5, 8})
    for (int n : {1, 2, 5}) {
      const TetMesh mesh = meshes::scaled(kuhnGrid(n, n, n), cell);
      const auto side = static_cast<std::uint64_t>(cell) * static_cast<std::uint64_t>(n);
      EXPECT_EQ(count(mesh, OccupancyPath::Boundary), side * side * side);
      EXPECT_EQ(count(mesh, OccupancyPath::Tets), side * side * side);
    }
}

TEST(Voxelize, EachTieHasOneOwner) {
  const TetMesh mesh = meshes::scaled(kuhnGrid(6, 6, 6), 3, {-9, 4, 1000});
  const auto voxels = oracle::voxels(mesh, {{1, 1, 1}, {0, 0, 0}});
  EXPECT_EQ(voxels.size(), 18u * 18u * 18u);
  for (const auto& [voxel, owner] : voxels)
    ASSERT_EQ(owner.count, 1u);
  expectOracle(mesh, unitVoxels({}));
}

TEST(Voxelize, AbuttingMeshesShareNoVoxelAndMissNone) {
  // A box cut by the plane through (0,0,0), (8,3,0), (0,0,1) into two meshes of their own.
  const auto half = [](double side) {
    return meshes::mapped(kuhnGrid(4, 4, 4), [&](const Vec3d& p) {
      const double x = p[0] * 2;
      const double cut = x * 3 / 8 + 2;
      return Vec3d{x, side < 0 ? cut * p[1] / 4 : cut + (8 - cut) * p[1] / 4, p[2] * 2};
    });
  };
  const TetMesh below = half(-1), above = half(1);
  for (OccupancyPath path : {OccupancyPath::Boundary, OccupancyPath::Tets}) {
    EXPECT_EQ(count(below, path) + count(above, path), 8u * 8u * 8u);
    EXPECT_EQ(count(meshes::joined(below, above), path), 8u * 8u * 8u);
  }
}

TEST(Voxelize, JitteredGridsMatchTheOracle) {
  for (double cell : {0.3, 0.9, 2.4, 7.0}) {
    const int n = cell < 1 ? 12 : 5;
    const TetMesh mesh = meshes::scaled(meshes::jittered(kuhnGrid(n, n, n), 0.2, 7, true), cell,
                                        {-0.4 * n * cell, 120.0, 3.1});
    expectOracle(mesh, unitVoxels({}));
  }
}

TEST(Voxelize, OverlapsFlipsAndFlatTetsMatchTheOracle) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    expectOracle(meshes::soup(60, 20, 8, seed, 5), unitVoxels({}));
    expectOracle(meshes::rounded(meshes::soup(60, 12, 5, seed, 5), 1.0), unitVoxels({}));
    expectOracle(meshes::rounded(meshes::soup(60, 12, 5, seed, 5), 0.5), unitVoxels({}));
  }
}

TEST(Voxelize, DuplicatedTetsAndPointsAreAUnion) {
  const TetMesh once = meshes::scaled(meshes::jittered(kuhnGrid(3, 3, 3), 0.2, 3, true), 4);
  TetMesh thrice = meshes::joined(once, once);
  thrice.tets.insert(thrice.tets.end(), once.tets.begin(), once.tets.end());
  thrice.cellCount = thrice.tetCount();
  expectOracle(thrice, unitVoxels({}));
  EXPECT_EQ(count(thrice, OccupancyPath::Boundary), count(once, OccupancyPath::Boundary));
}

TEST(Voxelize, GiantsAcrossNodesMatchTheOracle) {
  // Spans several 128^3 nodes; thin, so that the oracle's box stays small.
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    TetMesh mesh = meshes::soup(3, 10, 6, seed);
    meshes::Random random(seed);
    for (std::size_t i = 0; i < mesh.points.size(); i += 4) {
      mesh.points[i][seed % 3] += 700;
      mesh.points[i + 1][(seed + 1) % 3] -= 90;
    }
    expectOracle(mesh, unitVoxels({}));
  }
}

TEST(Voxelize, SlabsAndNeedlesMatchTheOracle) {
  // Faces a hair off the axes: steep crossings, long edges.
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    meshes::Random random(seed);
    TetMesh mesh = meshes::soup(30, 30, 12, seed);
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      const std::size_t axis = (i / 4) % 3;
      mesh.points[i][axis] = 10 + random.between(-1, 1) * (i % 8 < 4 ? 1e-6 : 0.6);
    }
    expectOracle(mesh, unitVoxels({}));
  }
}

RC_GTEST_PROP(VoxelizeProperties, SoupsMatchTheOracle, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint32_t>();
  const double size = *rc::gen::element(0.7, 2.0, 5.0, 14.0);
  const double step = *rc::gen::element(0.0, 0.25, 1.0);
  TetMesh mesh = meshes::soup(*rc::gen::inRange<std::size_t>(1, 40), 12, size, seed);
  if (step > 0)
    mesh = meshes::rounded(mesh, step);
  VoxelizeOptions options = unitVoxels({});
  options.voxelSize = {*rc::gen::element(1.0, 0.37), 1.0, *rc::gen::element(1.0, 2.5)};
  options.origin = {*rc::gen::element(0.0, 0.5, -77.7), 0.0, 0.25};
  expectOracle(mesh, options);
}

TEST(Voxelize, ResultIsTheSameForAnyThreadsOrderAndPath) {
  const TetMesh mesh = meshes::ball(12, 150, {3.7, -200.2, 90.1});
  const std::vector<GridKind> kinds{GridKind::Density, GridKind::Mask};
  const std::string expected = hash(run(mesh, unitVoxels(kinds, OccupancyPath::Boundary)).volume);
  EXPECT_EQ(hash(run(mesh, unitVoxels(kinds, OccupancyPath::Tets)).volume), expected);
  const TetMesh other = meshes::shuffled(mesh, 5);
  EXPECT_EQ(hash(run(other, unitVoxels(kinds, OccupancyPath::Boundary)).volume), expected);
  EXPECT_EQ(hash(run(other, unitVoxels(kinds, OccupancyPath::Tets)).volume), expected);

  const std::string ids = hash(run(mesh, unitVoxels({GridKind::TetId})).volume);
  for (int threads : {1, 2, 5}) {
    tbb::task_arena arena(threads);
    arena.execute([&] {
      EXPECT_EQ(hash(run(mesh, unitVoxels(kinds, OccupancyPath::Boundary)).volume), expected);
      EXPECT_EQ(hash(run(mesh, unitVoxels(kinds, OccupancyPath::Tets)).volume), expected);
      EXPECT_EQ(hash(run(mesh, unitVoxels({GridKind::TetId})).volume), ids);
    });
  }
}

TEST(Voxelize, ShufflingPermutesTetIdsAlone) {
  const TetMesh mesh = meshes::scaled(meshes::jittered(kuhnGrid(6, 6, 6), 0.2, 3, true), 6);
  std::vector<std::uint32_t> tetOf;
  const TetMesh other = meshes::shuffled(mesh, 11, &tetOf);
  const Voxelization a = run(mesh, unitVoxels({GridKind::TetId}));
  const Voxelization b = run(other, unitVoxels({GridKind::TetId}));
  const auto accessor = grid<openvdb::Int32Grid>(b).getConstAccessor();
  std::uint64_t seen = 0;
  for (auto it = grid<openvdb::Int32Grid>(a).cbeginValueOn(); it; ++it) {
    ASSERT_TRUE(it.isVoxelValue());
    ASSERT_EQ(static_cast<int>(tetOf[static_cast<std::size_t>(accessor.getValue(it.getCoord()))]),
              *it);
    ++seen;
  }
  EXPECT_EQ(seen, grid<openvdb::Int32Grid>(b).activeVoxelCount());
}

TEST(Voxelize, SolidsHaveTilesAtEveryLevel) {
  // One cube of six tets over a whole root child and a margin all round. Its sides lie between
  // leaves, but for those along x: these are leaves that are partly inside.
  const double side = 4096 + 304;
  const TetMesh mesh = meshes::scaled(kuhnGrid(1, 1, 1), side, {-150.5, -152.5, -152.5});
  std::vector<std::string> hashes;
  for (OccupancyPath path : {OccupancyPath::Boundary, OccupancyPath::Tets}) {
    const Voxelization v = run(mesh, unitVoxels({GridKind::Mask}, path));
    hashes.push_back(hash(v.volume));
    const auto& tree = grid<openvdb::BoolGrid>(v).tree();
    EXPECT_EQ(tree.activeVoxelCount(), 4400ull * 4400ull * 4400ull);
    EXPECT_EQ(tree.leafCount(), 2u * 550 * 550);
    std::uint64_t tiles[3] = {0, 0, 0};
    auto it = tree.cbeginValueOn();
    it.setMaxDepth(it.getLeafDepth() - 1);
    for (; it; ++it)
      ++tiles[it.getLevel() - 1];
    EXPECT_EQ(tiles[2], 1u); // 4096^3
    EXPECT_GT(tiles[1], 6u * 32 * 32);
    EXPECT_GT(tiles[0], 0u);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  // Floats in a cube that consists of tiles.
  const double wholeSide = test::scale() > 1 ? side : 1024 + 304;
  const TetMesh whole = meshes::scaled(kuhnGrid(1, 1, 1), wholeSide, {-152.5, -152.5, -152.5});
  EXPECT_EQ(hash(run(whole, unitVoxels({GridKind::Density}, OccupancyPath::Boundary)).volume),
            hash(run(whole, unitVoxels({GridKind::Density}, OccupancyPath::Tets)).volume));
}

TEST(Voxelize, OneTetThatFillsNodesOwnsThemAsTiles) {
  TetMesh mesh;
  mesh.points = {{-500, -500, -500}, {1000, -500, -500}, {-500, 1000, -500}, {-500, -500, 1000}};
  mesh.tets = {0, 1, 2, 3};
  mesh.cellCount = 1;
  const Voxelization v = run(mesh, unitVoxels({GridKind::TetId}));
  const auto& ids = grid<openvdb::Int32Grid>(v);
  std::uint64_t nodeTiles = 0;
  auto tile = ids.cbeginValueOn();
  tile.setMaxDepth(tile.getLeafDepth() - 1);
  for (; tile; ++tile) {
    ASSERT_EQ(*tile, 0);
    nodeTiles += tile.getLevel() == 2;
  }
  EXPECT_GT(nodeTiles, 50u);
  EXPECT_EQ(ids.activeVoxelCount(), run(mesh, unitVoxels({GridKind::Mask}, OccupancyPath::Boundary))
                                        .volume.grids()
                                        .all[0]
                                        ->activeVoxelCount());
  // A small tet before it keeps its voxels, one after it has none.
  mesh.points.insert(mesh.points.end(), {{-5, -5, -5}, {5, -5, -5}, {-5, 5, -5}, {-5, -5, 5}});
  mesh.tets = {4, 5, 6, 7, 0, 1, 2, 3, 4, 6, 5, 7};
  mesh.cellCount = 3;
  const Voxelization three = run(mesh, unitVoxels({GridKind::TetId}));
  const auto accessor = grid<openvdb::Int32Grid>(three).getConstAccessor();
  EXPECT_EQ(accessor.getValue(openvdb::Coord(-4)), 0);
  EXPECT_EQ(accessor.getValue(openvdb::Coord(-20)), 1);
  std::uint64_t first = 0;
  for (auto it = grid<openvdb::Int32Grid>(three).cbeginValueOn(); it; ++it) {
    ASSERT_NE(*it, 2);
    if (*it == 0)
      first += it.getVoxelCount();
  }
  TetMesh small;
  small.points = {{-5, -5, -5}, {5, -5, -5}, {-5, 5, -5}, {-5, -5, 5}};
  small.tets = {0, 1, 2, 3};
  const auto voxelsOfSmall = oracle::voxels(small, {{1, 1, 1}, {0, 0, 0}}).size();
  EXPECT_EQ(first, voxelsOfSmall);
  EXPECT_EQ(three.counts.flipped, 1u);
}

TEST(Voxelize, VolumesConvergeWithResolution) {
  const double pi = std::acos(-1.0);
  const auto error = [&](const TetMesh& mesh, double exact, double size) {
    VoxelizeOptions options = unitVoxels({GridKind::Mask});
    options.voxelSize = {size, size, size};
    const Voxelization v = run(mesh, options);
    const double volume =
        static_cast<double>(v.volume.grids().all[0]->activeVoxelCount()) * size * size * size;
    return std::abs(volume - exact) / exact;
  };
  // The mesh's own volume is the truth that voxels converge to.
  const auto meshVolume = [](const TetMesh& mesh) {
    double sum = 0;
    for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
      Vec3d e[3];
      const Vec3d& o = mesh.points[mesh.tets[4 * t]];
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k)
          e[i][k] = mesh.points[mesh.tets[4 * t + i + 1]][k] - o[k];
      sum += std::abs(e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                      e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                      e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
             6;
    }
    return sum;
  };
  const TetMesh ball = meshes::ball(16, 1, {0.1, 0.2, 0.3});
  EXPECT_NEAR(meshVolume(ball), 4 * pi / 3, 0.04);
  const TetMesh torus = meshes::mapped(kuhnGrid(48, 8, 8), [&](const Vec3d& p) {
    // A square bar swept round; its ends meet.
    const double angle = 2 * pi * p[0] / 48, u = p[1] / 8 - 0.5, v = p[2] / 8 - 0.5;
    return Vec3d{(2 + u) * std::cos(angle), (2 + u) * std::sin(angle), v};
  });
  const TetMesh box = meshes::mapped(kuhnGrid(3, 3, 3), [](const Vec3d& p) {
    const double c = std::cos(0.5), s = std::sin(0.5);
    const double x = p[0] / 3, y = p[1] / 3, z = p[2] / 3;
    return Vec3d{c * x - s * y, c * (s * x + c * y) - s * z, s * (s * x + c * y) + c * z};
  });
  for (const TetMesh* mesh : {&ball, &torus, &box}) {
    const double exact = meshVolume(*mesh);
    EXPECT_LT(error(*mesh, exact, 1.0 / 16), 2e-2);
    EXPECT_LT(error(*mesh, exact, 1.0 / 64), 2e-3);
    EXPECT_LT(error(*mesh, exact, 1.0 / 256), 2e-4);
  }
}

TEST(Voxelize, MaterialIsTheRegionOfTheOwner) {
  TetMesh mesh = meshes::scaled(kuhnGrid(2, 2, 2), 4);
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    mesh.cellOfTet.push_back(static_cast<std::uint32_t>(t / 6));
    mesh.regions.resize(t / 6 + 1, 10 + static_cast<std::int32_t>(t / 6));
  }
  mesh.cellCount = mesh.regions.size();
  const Voxelization v =
      run(mesh, unitVoxels({GridKind::Material, GridKind::TetId, GridKind::Mask}));
  std::map<int, int> voxels;
  for (auto it = grid<openvdb::Int32Grid>(v).cbeginValueOn(); it; ++it)
    voxels[*it] += static_cast<int>(it.getVoxelCount());
  ASSERT_EQ(voxels.size(), 8u);
  for (const auto& [region, n] : voxels)
    EXPECT_EQ(n, 64) << region;
  EXPECT_EQ(grid<openvdb::Int32Grid>(v, 1).activeVoxelCount(), 512u);
  EXPECT_EQ(grid<openvdb::BoolGrid>(v, 2).activeVoxelCount(), 512u);
}

TEST(Voxelize, CountsFlipsAndDropsOnBothPaths) {
  TetMesh mesh = meshes::soup(500, 200, 3, 21, 40);
  for (OccupancyPath path : {OccupancyPath::Boundary, OccupancyPath::Tets}) {
    const SnapCounts counts = run(mesh, unitVoxels({GridKind::Mask}, path)).counts;
    EXPECT_EQ(counts.dropped, 40u);
    EXPECT_GT(counts.flipped, 200u);
    EXPECT_EQ(counts.flipped, run(mesh, unitVoxels({GridKind::TetId})).counts.flipped);
  }
}

Status failure(const TetMesh& mesh, const VoxelizeOptions& options) {
  try {
    run(mesh, options);
  } catch (const Error& e) {
    return e.status();
  }
  return Status::Ok;
}

TEST(Voxelize, RefusesWhatItCannotDo) {
  const TetMesh mesh = kuhnGrid(1, 1, 1);
  VoxelizeOptions options = unitVoxels({GridKind::Mask});
  for (double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    options.voxelSize = {1, bad, 1};
    EXPECT_EQ(failure(mesh, options), Status::Usage);
  }
  options.voxelSize = {1, 0, 1};
  EXPECT_EQ(failure(mesh, options), Status::Usage);
  options.voxelSize = {1e-5, 1e-5, 1e-5};
  EXPECT_EQ(failure(mesh, options), Status::Usage);
  options.voxelSize = {1, 1, 1};
  EXPECT_EQ(failure(meshes::scaled(mesh, 1e10), options), Status::Limit);
  EXPECT_EQ(failure(meshes::scaled(mesh, 2e6), options), Status::Limit); // 2^20 voxels a tet
  options.maxMemory = 1000;
  EXPECT_EQ(failure(mesh, options), Status::Limit);
  options.maxMemory = 0;
  TetMesh infinite = mesh;
  infinite.points[0][1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(failure(infinite, options), Status::Invalid);
  options.allowEmpty = false;
  EXPECT_EQ(failure(meshes::scaled(mesh, 0.1, {0.3, 0.3, 0.3}), options), Status::Invalid);
  EXPECT_EQ(failure(TetMesh{}, options), Status::Invalid);
  options.grids.clear();
  EXPECT_EQ(failure(mesh, options), Status::Usage);
}

TEST(Voxelize, FarModelsMoveTheOriginByWholeRootChildren) {
  const TetMesh mesh = meshes::scaled(kuhnGrid(1, 1, 1), 10, {1e10, -3e10, 0});
  Report report;
  Progress progress;
  const Voxelization v = voxelize(mesh, unitVoxels({GridKind::Mask}), report, progress);
  EXPECT_EQ(std::fmod(v.transform.origin[0], 4096), 0);
  EXPECT_EQ(std::fmod(v.transform.origin[1], 4096), 0);
  EXPECT_EQ(v.transform.origin[2], 0);
  EXPECT_EQ(v.volume.grids().all[0]->activeVoxelCount(), 1000u);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0].code, "origin-moved");
}

TEST(Voxelize, StopsWhenCancelled) {
  Report report;
  Progress progress;
  progress.cancel();
  try {
    voxelize(meshes::ball(10, 50, {0, 0, 0}), unitVoxels({GridKind::Mask}), report, progress);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.status(), Status::Cancelled);
  }
}

} // namespace
