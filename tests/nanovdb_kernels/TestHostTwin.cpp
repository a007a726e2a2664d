// SPDX-License-Identifier: Apache-2.0
//
// The device's steps, run by their twin on the host, against the CPU's voxelize(), which shares no
// code with them but the exact predicates.
#include "FileBytes.h"
#include "Grids.h"
#include "Meshes.h"
#include "TestScale.h"
#include "io/VolumeSamples.h"
#include "nanovdb_kernels/AnySoup.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/volume/NanoFile.h"

#include <cstdio>
#include <gtest/gtest.h>
#include <initializer_list>
#include <limits>
#include <rapidcheck/gtest.h>
#include <vector>

namespace {

using namespace tetvdb;
using meshes::kuhnGrid;
using nano::GridType;
using nano::Method;

/// Of balls that reach through several upper nodes, in voxels.
const double kLargeRadius = test::scale() > 1 ? 900 : 400;

std::string twinHash(const TetMesh& mesh, const nano::Job& job) {
  nano::HostTwin twin;
  return hashOf(twin.run(viewOf(mesh), job));
}

// All types of grid and all methods that take the mesh.
void expectSame(const TetMesh& mesh, const GridTransform& transform = {}, bool dense = true) {
  const std::string mask = cpuHash(mesh, GridKind::Mask, transform);
  EXPECT_EQ(twinHash(mesh, jobFor(GridType::Mask, Method::Boundary, transform)), mask);
  EXPECT_EQ(twinHash(mesh, jobFor(GridType::Bool, Method::Boundary, transform)), mask);
  if (dense) {
    EXPECT_EQ(twinHash(mesh, jobFor(GridType::Mask, Method::Tets, transform)), mask);
  }
  EXPECT_EQ(twinHash(mesh, jobFor(GridType::Fog, Method::Boundary, transform)),
            cpuHash(mesh, GridKind::Density, transform));
  EXPECT_EQ(twinHash(mesh, jobFor(GridType::Owner, Method::Auto, transform)),
            cpuHash(mesh, GridKind::TetId, transform));
}

TEST(HostTwin, LatticeWhereEveryCentreIsATie) {
  for (int cell : {1, 3, 8})
    expectSame(meshes::scaled(kuhnGrid(3, 3, 3), cell));
}

TEST(HostTwin, NegativeCoordinatesAndAnisotropicVoxels) {
  expectSame(meshes::scaled(kuhnGrid(3, 4, 5), 7.3, {-20.1, -5000.7, 3.3}),
             {{0.9, 1.1, 1.7}, {0.25, -3, 8}});
}

TEST(HostTwin, OverlapsFlipsAndFlatTets) {
  expectSame(meshes::soup(300, 40, 9, 1, 5));
  expectSame(meshes::rounded(meshes::soup(300, 20, 5, 2, 5), 0.5));
}

TEST(HostTwin, DuplicatedTets) {
  const TetMesh mesh = meshes::jittered(kuhnGrid(4, 4, 4), 0.3, 3);
  expectSame(meshes::scaled(meshes::joined(mesh, mesh), 4));
}

TEST(HostTwin, TetsFarBelowAVoxel) {
  expectSame(meshes::scaled(meshes::jittered(kuhnGrid(12, 12, 12), 0.3, 4), 0.3));
}

TEST(HostTwin, GiantsAcrossNodes) {
  expectSame(meshes::scaled(kuhnGrid(1, 1, 1), 300, {-40, -30, -20}));
  expectSame(meshes::soup(4, 300, 200, 6));
}

TEST(HostTwin, TinyAndLargeTetsInOneMesh) {
  expectSame(meshes::joined(meshes::soup(400, 100, 0.7, 7), meshes::soup(3, 100, 90, 8)));
}

// Tiles of every level, and gaps whose columns differ: a box that ends at leaf and node borders.
TEST(HostTwin, TilesAtEveryLevel) {
  const auto occupancy = [](const TetMesh& mesh) {
    EXPECT_EQ(twinHash(mesh, jobFor(GridType::Fog, Method::Boundary, {})),
              cpuHash(mesh, GridKind::Density, {}));
  };
  occupancy(meshes::scaled(kuhnGrid(1, 1, 1), 256));
  occupancy(meshes::scaled(kuhnGrid(1, 1, 1), 256, {0.5, 0.5, 0.5}));
  occupancy(meshes::mapped(kuhnGrid(1, 1, 1), [](const Vec3d& p) {
    return Vec3d{p[0] * 200, p[1] * 72, p[2] * 1000};
  }));
  occupancy(meshes::mapped(kuhnGrid(1, 1, 1), [](const Vec3d& p) {
    return Vec3d{p[0] * 20 + 3, p[1] * 12 + 1, p[2] * 9000 - 4100};
  }));
  // A root tile, and striped upper nodes, above one another where tests are scaled up; the walls
  // lie between leaves.
  const double low = test::scale() > 1 ? -4500 : -200;
  occupancy(meshes::mapped(kuhnGrid(1, 1, 1), [&](const Vec3d& p) {
    return Vec3d{p[0] * 4504 - 200, p[1] * 4400 - 104, p[2] * (4500 - low) + low};
  }));
}

// Dense masks over several upper nodes, and faces that floats say nothing of.
TEST(HostTwin, DenseMasks) {
  const auto check = [](const TetMesh& mesh) {
    EXPECT_EQ(twinHash(mesh, jobFor(GridType::Mask, Method::Tets, {})),
              cpuHash(mesh, GridKind::Mask, {}));
  };
  check(meshes::ball(6, 200, {0, 0, 0}));
  check(meshes::ball(3, kLargeRadius, {4000, -4000, 8100}));
  check(meshes::scaled(kuhnGrid(2, 2, 2), 127, {-128, -128, -128}));
  // Sheared: faces all but parallel to z, and slivers.
  for (const double shear : {0x1p-20, 0x1p-14, 1e-3})
    check(meshes::mapped(kuhnGrid(5, 5, 5), [&](const Vec3d& p) {
      return Vec3d{p[0] * 9 + shear * p[2] * 30, p[1] * 7 - shear * p[2] * 9, p[2] * 30 + 0.5};
    }));
  check(meshes::mapped(meshes::soup(400, 60, 8, 5), [](const Vec3d& p) {
    return Vec3d{p[0], p[1] * 1e-3 + 3, p[2]};
  }));
  check(meshes::mapped(meshes::soup(200, 300, 90, 6), [](const Vec3d& p) {
    return Vec3d{p[0] * 1e-4 + 7, p[1], p[2]};
  }));
}

TEST(HostTwin, BallAndShuffledBall) {
  const TetMesh ball = meshes::ball(8, 60, {3, -70, 100});
  expectSame(ball);
  expectSame(meshes::shuffled(ball, 9));
}

RC_GTEST_PROP(HostTwinProperties, Soups, ()) {
  expectSame(meshes::anySoup());
}

// Several devices share a grid by columns of root tiles: these meshes lie in four or more.
TEST(HostTwin, SharesMakeTheSameBuffer) {
  const auto check = [](const TetMesh& mesh, std::initializer_list<GridType> types, Method method) {
    for (GridType type : types) {
      const nano::Job job = jobFor(type, method, {});
      nano::HostTwin one, several;
      const nano::Result whole = one.run(viewOf(mesh), job);
      for (int shares : test::scale() > 1 ? std::vector<int>{2, 7} : std::vector<int>{7}) {
        const nano::Result shared = several.run(viewOf(mesh), job, shares);
        EXPECT_TRUE(sameBytes(shared, whole)) << int(type) << " by " << shares;
        EXPECT_EQ(shared.counts.leaves, whole.counts.leaves);
        EXPECT_EQ(shared.counts.rootTiles, whole.counts.rootTiles);
      }
    }
  };
  const TetMesh around = meshes::soup(60, 120, 25, 3, 2);
  const TetMesh origin = meshes::mapped(around, [](const Vec3d& p) {
    return Vec3d{p[0] - 60, p[1] - 60, p[2] - 60};
  });
  check(origin, {GridType::Mask, GridType::Bool, GridType::Fog}, Method::Boundary);
  check(origin, {GridType::Mask, GridType::Fog}, Method::Tets);
  check(origin, {GridType::Owner}, Method::Auto);
  // Root tiles, and columns of them without any leaf.
  const TetMesh box = meshes::mapped(kuhnGrid(1, 1, 1), [](const Vec3d& p) {
    return Vec3d{p[0] * 12300 - 4100, p[1] * 40 - 20, p[2] * 8200 - 4098};
  });
  check(box, {GridType::Mask}, Method::Boundary);
  check(TetMesh(), {GridType::Mask}, Method::Auto);
}

TEST(HostTwin, EmptyGrids) {
  const TetMesh speck = meshes::scaled(kuhnGrid(1, 1, 1), 0.1, {0.5, 0.5, 0.5});
  expectSame(speck);
  nano::HostTwin twin;
  EXPECT_EQ(twin.run(viewOf(TetMesh()), jobFor(GridType::Mask, Method::Auto, {})).counts.leaves,
            0u);
}

TEST(HostTwin, ValuesOfTets) {
  const TetMesh mesh = meshes::scaled(kuhnGrid(4, 4, 4), 9);
  TetMesh cells = mesh;
  cells.regions.resize(mesh.tetCount());
  for (std::size_t t = 0; t < mesh.tetCount(); ++t)
    cells.regions[t] = static_cast<std::int32_t>(t / 200) - 1;
  nano::HostTwin twin;
  nano::MeshView view = viewOf(mesh);
  view.values = cells.regions.data();
  nano::Job job = jobFor(GridType::Owner, Method::Auto, {});
  job.name = "material";
  EXPECT_EQ(hashOf(twin.run(view, job)), cpuHash(cells, GridKind::Material, {}));
}

// The reader checks every node against the full checksum that writing adds.
TEST(HostTwin, FilesFromBuffersReadBack) {
  const TetMesh mesh = meshes::ball(5, 90, {10, 20, 30});
  nano::HostTwin twin;
  const nano::Result result =
      twin.run(viewOf(mesh), jobFor(GridType::Owner, Method::Auto, GridTransform{}));
  const std::string path = testing::TempDir() + "twin.nvdb";
  Progress progress;
  writeNanoGrids(path, {{{std::shared_ptr<void>(), result.bytes}, result.counts.bufferBytes, 0}},
                 progress);
  EXPECT_EQ(hash(readVolume(path, progress)), cpuHash(mesh, GridKind::TetId, GridTransform{}));
  std::remove(path.c_str());
}

// Checksums included.
TEST(HostTwin, FilesFromBuffersAreThoseOfTrees) {
  const TetMesh mesh = meshes::ball(5, 90, {10, 20, 30});
  nano::HostTwin twin;
  Progress progress;
  for (const GridType type : {GridType::Bool, GridType::Fog}) {
    const nano::Result result = twin.run(viewOf(mesh), jobFor(type, Method::Auto, {}));
    const std::string path = testing::TempDir() + "twin.nvdb";
    writeNanoGrids(path, {{{std::shared_ptr<void>(), result.bytes}, result.counts.bufferBytes, 0}},
                   progress);
    const std::string bytes = test::fileBytes(path);
    Volume volume;
    volume.grids().all = {gridOfNano(result.bytes)};
    writeVolume(path, volume, progress);
    EXPECT_TRUE(bytes == test::fileBytes(path));
    std::remove(path.c_str());
  }
}

// Counted node by node.
TEST(HostTwin, BuffersAreDescribedAsTheirTrees) {
  nano::HostTwin twin;
  for (const TetMesh& mesh :
       {meshes::ball(5, 90, {10, 20, 30}), meshes::ball(3, kLargeRadius, {-7, 4000, 0}),
        meshes::scaled(kuhnGrid(2, 2, 2), 64), meshes::scaled(kuhnGrid(1, 1, 1), 0.1)})
    for (const GridType type : {GridType::Mask, GridType::Bool, GridType::Fog, GridType::Owner}) {
      nano::Job job = jobFor(type, Method::Auto, {{0.5, 0.5, 0.5}, {1, 2, 3}});
      job.voxelSize[0] = job.voxelSize[1] = job.voxelSize[2] = type == GridType::Owner ? 8 : 2;
      const nano::Result result = twin.run(viewOf(mesh), job);
      Volume volume;
      volume.grids().all = {gridOfNano(result.bytes)};
      const GridInfo expected = describe(volume).front(), info = describeNano(result.bytes);
      test::expectSameCounts(info, expected);
      EXPECT_EQ(info.name, expected.name);
      EXPECT_EQ(info.gridClass, expected.gridClass);
      EXPECT_EQ(info.metadata, expected.metadata);
      EXPECT_EQ(info.transform.voxelSize, expected.transform.voxelSize);
      EXPECT_EQ(info.transform.origin, expected.transform.origin);
      EXPECT_EQ(info.linear, expected.linear);
      EXPECT_EQ(info.volume, expected.volume);
    }
}

TEST(HostTwin, CountsFlipsAndDrops) {
  nano::HostTwin twin;
  TetMesh mesh = meshes::soup(50, 10, 3, 11, 7);
  Report report;
  Progress progress;
  VoxelizeOptions options;
  options.voxelSize = {1, 1, 1};
  const SnapCounts expected = voxelize(mesh, options, report, progress).counts;
  const nano::Counts counts =
      twin.run(viewOf(mesh), jobFor(GridType::Mask, Method::Boundary, {})).counts;
  EXPECT_EQ(counts.flipped, expected.flipped);
  EXPECT_EQ(counts.dropped, expected.dropped);
}

TEST(HostTwin, RefusesWhatItCannotDo) {
  const auto statusOf = [](const TetMesh& mesh, double voxel = 1) {
    nano::HostTwin twin;
    try {
      twin.run(viewOf(mesh),
               jobFor(GridType::Mask, Method::Boundary, {{voxel, voxel, voxel}, {0, 0, 0}}));
    } catch (const Error& e) {
      return e.status();
    }
    return Status::Ok;
  };
  TetMesh mesh = kuhnGrid(1, 1, 1);
  EXPECT_EQ(statusOf(mesh), Status::Ok);
  EXPECT_EQ(statusOf(mesh, 1e-7), Status::Limit); // a tet of 10^7 voxels
  {
    nano::HostTwin twin;
    const TetMesh wide = meshes::scaled(mesh, 2200); // for masks of all leaves at once
    EXPECT_THROW(twin.run(viewOf(wide), jobFor(GridType::Mask, Method::Tets, {})), Error);
  }
  EXPECT_EQ(statusOf(mesh, -1), Status::Usage);
  mesh.points[3][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(statusOf(mesh), Status::Limit);
  mesh = kuhnGrid(1, 1, 1);
  mesh.tets[5] = 8;
  EXPECT_EQ(statusOf(mesh), Status::Invalid);
}

} // namespace
