// SPDX-License-Identifier: Apache-2.0
//
// Level sets made by the device's steps, run by their twin on the host, against those of the CPU.
#include "LevelSetCases.h"
#include "fields/BruteDistance.h"
#include "nanovdb_kernels/AnySoup.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/NanoVdb.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace {

using namespace tetvdb;
using meshes::kuhnGrid;
using Grid = nanovdb::NanoGrid<float>;

struct Sums {
  double count = 0, sum = 0, squares = 0;
  float min = 1e30f, max = -1e30f;

  void add(float v, double voxels = 1) {
    count += voxels;
    sum += voxels * v;
    squares += voxels * v * v;
    min = std::min(min, v);
    max = std::max(max, v);
  }
  template <typename Node>
  void expect(const Node& node) const {
    EXPECT_EQ(node.mMinimum, min);
    EXPECT_EQ(node.mMaximum, max);
    EXPECT_NEAR(node.mAverage, sum / count, 1e-4);
    const double deviation = std::sqrt(std::max(0.0, squares / count - sum * sum / count / count));
    EXPECT_NEAR(node.mStdDevi, deviation, 1e-3);
  }
};

template <typename Leaf>
void addLeaf(const Leaf& leaf, Sums& sums, nanovdb::CoordBBox& box) {
  for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
    sums.add(*voxel);
    box.expand(voxel.getCoord());
  }
}

// Every node's box and statistics, by NanoVDB's own iterators.
void expectStatistics(const nano::Result& result) {
  const auto& grid = *reinterpret_cast<const Grid*>(result.bytes);
  EXPECT_EQ(grid.gridClass(), nanovdb::GridClass::LevelSet);
  EXPECT_EQ(grid.gridSize(), result.counts.bufferBytes);
  Sums all;
  nanovdb::CoordBBox whole;
  const auto& tree = grid.tree();
  for (std::uint32_t i = 0; i < tree.nodeCount(0); ++i) {
    Sums sums;
    nanovdb::CoordBBox box;
    const auto& leaf = tree.getFirstNode<0>()[i];
    addLeaf(leaf, sums, box);
    sums.expect(*leaf.data());
    EXPECT_EQ(leaf.bbox(), box);
    addLeaf(leaf, all, whole);
  }
  for (std::uint32_t i = 0; i < tree.nodeCount(1); ++i) {
    Sums sums;
    nanovdb::CoordBBox box;
    const auto& lower = tree.getFirstNode<1>()[i];
    for (auto leaf = lower.beginChild(); leaf; ++leaf)
      addLeaf(*leaf, sums, box);
    sums.expect(*lower.data());
    EXPECT_EQ(lower.bbox(), box);
    EXPECT_TRUE(lower.valueMask().isOff());
  }
  for (std::uint32_t i = 0; i < tree.nodeCount(2); ++i)
    EXPECT_TRUE(tree.getFirstNode<2>()[i].valueMask().isOff());
  EXPECT_EQ(double(grid.activeVoxelCount()), all.count);
  EXPECT_EQ(tree.activeTileCount(1) + tree.activeTileCount(2) + tree.activeTileCount(3), 0u);
  if (all.count == 0)
    return;
  all.expect(*tree.root().data());
  EXPECT_EQ(grid.indexBBox(), whole);
}

// The sums of a node of fog, whose active tiles have the value 1.
template <typename Node>
void addTiles(const Node& node, double voxels, Sums& sums) {
  for (auto tile = node.beginValueOn(); tile; ++tile) {
    EXPECT_EQ(*tile, 1);
    sums.add(*tile, voxels);
  }
}

// Every node's statistics.
void expectFog(const nano::Result& result) {
  const auto& grid = *reinterpret_cast<const Grid*>(result.bytes);
  EXPECT_EQ(grid.gridClass(), nanovdb::GridClass::FogVolume);
  EXPECT_EQ(grid.gridSize(), result.counts.bufferBytes);
  const auto& tree = grid.tree();
  EXPECT_EQ(tree.background(), 0);
  Sums all;
  nanovdb::CoordBBox unused;
  std::uint64_t nodes[3] = {};
  const auto addLower = [&](const auto& lower, Sums& sums) {
    for (auto leaf = lower.beginChild(); leaf; ++leaf) {
      Sums ofLeaf;
      addLeaf(*leaf, ofLeaf, unused);
      EXPECT_GT(ofLeaf.count, 0);
      ofLeaf.expect(*leaf->data());
      addLeaf(*leaf, sums, unused);
      ++nodes[0];
    }
    addTiles(lower, 512, sums);
    ++nodes[1];
  };
  for (std::uint32_t i = 0; i < tree.nodeCount(2); ++i) {
    Sums sums;
    const auto& upper = tree.getFirstNode<2>()[i];
    for (auto lower = upper.beginChild(); lower; ++lower) {
      Sums ofLower;
      addLower(*lower, ofLower);
      EXPECT_GT(ofLower.count, 0);
      ofLower.expect(*lower->data());
      addLower(*lower, sums);
    }
    addTiles(upper, double(1 << 21), sums);
    EXPECT_GT(sums.count, 0);
    sums.expect(*upper.data());
    all.count += sums.count;
    ++nodes[2];
  }
  EXPECT_EQ(nodes[0], 2 * tree.nodeCount(0)); // visited twice each
  EXPECT_EQ(nodes[1], 2 * tree.nodeCount(1));
  EXPECT_EQ(nodes[2], tree.nodeCount(2));
  const double atRoot = double(tree.activeTileCount(3)) * std::pow(2.0, 36);
  EXPECT_EQ(double(grid.activeVoxelCount()), all.count + atRoot);
}

template <typename Mesh>
nano::Result expectSame(nano::HostTwin& twin, const Mesh& mesh, const BandCase& band,
                        nano::LevelSetJob job) {
  const nano::Result fog = twin.levelSet(viewOf(mesh), fogJobOf(job));
  EXPECT_EQ(hashOf(fog), fogHash(band));
  EXPECT_EQ(reinterpret_cast<const Grid*>(fog.bytes)->activeVoxelCount(),
            band.inside->activeVoxelCount());
  expectFog(fog);
  const nano::Result result = twin.levelSet(viewOf(mesh), job);
  EXPECT_NE(result.bytes, nullptr);
  EXPECT_EQ(hashOf(result), levelSetHash(band, rasterizeBand));
  EXPECT_EQ(result.counts.insideVoxels, band.inside->activeVoxelCount());
  return result;
}

void expectTets(const TetMesh& mesh, const GridTransform& transform = {}, double halfWidth = 3) {
  nano::HostTwin twin;
  expectStatistics(expectSame(twin, mesh, bandOf(mesh, transform, halfWidth),
                              levelSetJobFor(transform, halfWidth)));
}

TEST(LevelSetGrid, Tets) {
  expectTets(meshes::scaled(kuhnGrid(2, 2, 2), 17, {-20, -130, 3}));
  expectTets(meshes::scaled(kuhnGrid(2, 1, 1), 25.3, {0, -9, 124}), {}, 6.25);
  expectTets(meshes::scaled(kuhnGrid(3, 3, 3), 8), {{0.37, 0.37, 0.37}, {0.1, -7, 300}}, 1);
  expectTets(meshes::soup(300, 40, 9, 1, 5));
  expectTets(meshes::rounded(meshes::soup(300, 20, 5, 2, 5), 0.5), {}, 2);
}

// Tiles in lower, upper and root nodes, inside and outside.
TEST(LevelSetGrid, TilesOfAllLevels) {
  const TetMesh cube = meshes::scaled(kuhnGrid(1, 1, 1), 400, {-41.5, 3, 3900});
  nano::HostTwin twin;
  const nano::Result made = expectSame(twin, cube, bandOf(cube), levelSetJobFor({}, 3));
  expectStatistics(made);
  const auto& tree = reinterpret_cast<const Grid*>(made.bytes)->tree();
  EXPECT_EQ(tree.getValue({100, 100, 4000}), -3); // of a tile of the size of a leaf or a node
  EXPECT_EQ(tree.getValue({1000, 100, 4000}), 3);
}

// Nodes of the level set that have no leaf of fog, and leaves that have none of its voxels inside.
TEST(LevelSetGrid, SidesOnCentresAtTheEndOfLeaves) {
  const TetMesh box = meshes::mapped(kuhnGrid(1, 1, 1), [](const Vec3d& p) {
    return Vec3d{-300 + 364 * p[0], -300 + 600 * p[1], -300 + 600 * p[2]};
  });
  expectTets(box, {}, 1);
  expectTets(meshes::scaled(kuhnGrid(1, 1, 1), 64), {}, 1);
}

// A rod across whole upper nodes.
TEST(LevelSetGrid, LongRod) {
  expectTets(meshes::mapped(kuhnGrid(1, 1, 1), [](const Vec3d& p) {
    return Vec3d{p[0] * 9000 - 4500, p[1] * 9 + p[0] * 40, p[2] * 7 - 1};
  }));
}

TEST(LevelSetGrid, Triangles) {
  std::size_t i = 0;
  constexpr FillRule kRules[] = {FillRule::Positive, FillRule::NonZero, FillRule::Odd};
  for (const SoupCase& c : soupCases(true)) {
    if (c.transform.voxelSize[0] != c.transform.voxelSize[1] ||
        c.transform.voxelSize[1] != c.transform.voxelSize[2])
      continue;
    SCOPED_TRACE(c.name);
    const FillRule rule = kRules[i++ % 3];
    nano::LevelSetJob job = levelSetJobFor(c.transform, 3);
    job.rule = rule;
    nano::HostTwin twin;
    expectStatistics(expectSame(twin, c.mesh, bandOf(c.mesh, rule, c.transform, 3), job));
  }
  EXPECT_GT(i, 5u);
}

// Against distances that share no code with the library's.
TEST(LevelSetGrid, TrueDistances) {
  const TetMesh mesh = meshes::scaled(kuhnGrid(1, 1, 2), 9.3, {-70, 3, 60});
  const BandCase band = bandOf(mesh);
  nano::HostTwin twin;
  const nano::Result made = twin.levelSet(viewOf(mesh), levelSetJobFor({}, 3));
  const auto& grid = *reinterpret_cast<const Grid*>(made.bytes);
  std::vector<std::uint32_t> corners;
  for (const BoundaryFace& f : band.faces.faces)
    corners.insert(corners.end(), {f.a, f.b, f.c});
  std::vector<Vec3d> points;
  const double unit = double(kUnitsPerVoxel);
  for (std::size_t i = 0; i < band.mesh.pointCount; ++i)
    points.push_back(
        {band.mesh.points[i].x / unit, band.mesh.points[i].y / unit, band.mesh.points[i].z / unit});
  std::uint64_t surely = 0, perhaps = 0; // within the half-width
  const nanovdb::CoordBBox box = grid.indexBBox();
  for (int x = box.min()[0]; x <= box.max()[0]; ++x)
    for (int y = box.min()[1]; y <= box.max()[1]; ++y)
      for (int z = box.min()[2]; z <= box.max()[2]; ++z) {
        const double truth = double(oracle::distanceToAll(
            {(long double)x, (long double)y, (long double)z}, points, corners));
        const float value = grid.tree().getValue({x, y, z});
        surely += truth < 3 - kDistanceError;
        perhaps += truth < 3 + kDistanceError;
        ASSERT_NEAR(std::abs(value), std::min(truth, 3.0), kDistanceError);
        ASSERT_EQ(value < 0, band.inside->tree().isValueOn({x, y, z}));
      }
  EXPECT_GE(grid.activeVoxelCount(), surely);
  EXPECT_LE(grid.activeVoxelCount(), perhaps);
  EXPECT_GT(surely, 1000u);
}

// Distances to a part of the faces, and to others that follow the surface.
TEST(LevelSetGrid, OtherFaces) {
  const TetMesh mesh = meshes::scaled(kuhnGrid(3, 3, 3), 11.3, {-20, -130, 3});
  const TetMesh finer = meshes::scaled(kuhnGrid(1, 1, 1), 33.9, {-20, -130, 3});
  BandCase band = bandOf(mesh);
  const BandCase other = bandOf(finer);
  band.mesh = other.mesh;
  band.faces = other.faces;
  nano::LevelSetJob job = levelSetJobFor({}, 3);
  job.faces = facesViewOf(band.mesh, band.faces);
  nano::HostTwin twin;
  expectSame(twin, mesh, band, job);
}

// Within leaves, tiles and nothing, in rows that begin and end anywhere.
TEST(LevelSetGrid, ValuesAsADenseArray) {
  const TetMesh mesh = meshes::scaled(kuhnGrid(1, 1, 1), 60, {-31.5, 3, 100});
  nano::HostTwin twin;
  const nano::Result made = twin.levelSet(viewOf(mesh), levelSetJobFor({}, 3));
  const auto& tree = reinterpret_cast<const Grid*>(made.bytes)->tree();
  for (const nano::VoxelRange& range :
       {nano::VoxelRange{{-40, -5, 90}, {80, 75, 83}}, nano::VoxelRange{{0, 30, 125}, {1, 2, 5}},
        nano::VoxelRange{{-3, -3, -3}, {4, 0, 4}}}) {
    std::vector<float> values(std::size_t(range.size[0]) * range.size[1] * range.size[2] + 1, 77);
    twin.expandValues(made, range, values.data());
    std::size_t at = 0;
    for (std::uint32_t x = 0; x < range.size[0]; ++x)
      for (std::uint32_t y = 0; y < range.size[1]; ++y)
        for (std::uint32_t z = 0; z < range.size[2]; ++z)
          ASSERT_EQ(values[at++], tree.getValue({range.min[0] + int(x), range.min[1] + int(y),
                                                 range.min[2] + int(z)}));
    EXPECT_EQ(values[at], 77);
  }
}

TEST(LevelSetGrid, NothingInside) {
  expectTets(meshes::scaled(kuhnGrid(1, 1, 1), 0.1, {0.5, 0.5, 0.5}));
  nano::HostTwin twin;
  TetMesh none;
  none.points = {{1, 2, 3}};
  const nano::Result made = twin.levelSet(viewOf(none), levelSetJobFor({}, 3));
  ASSERT_NE(made.bytes, nullptr);
  EXPECT_EQ(made.counts.leaves, 0u);
  EXPECT_EQ(reinterpret_cast<const Grid*>(made.bytes)->tree().background(), 3);
}

TEST(LevelSetGrid, OpenTrianglesGiveNothing) {
  TriangleMesh mesh = meshes::sphere({0, 0, 0}, 10, 6);
  mesh.triangles.resize(mesh.triangles.size() - 3);
  mesh.faceCount = mesh.triangleCount();
  nano::HostTwin twin;
  const nano::Result made = twin.levelSet(viewOf(mesh), levelSetJobFor({}, 3));
  EXPECT_EQ(made.bytes, nullptr);
  EXPECT_EQ(made.counts.openEdges, 3u);
}

TEST(LevelSetGrid, RefusesOtherHalfWidths) {
  const TetMesh mesh = kuhnGrid(1, 1, 1);
  nano::HostTwin twin;
  for (const double halfWidth : {0.5, 101.0, std::nan("")})
    EXPECT_THROW(twin.levelSet(viewOf(mesh), levelSetJobFor({}, halfWidth)), Error);
}

RC_GTEST_PROP(LevelSetGridProperties, Soups, ()) {
  const TetMesh mesh = meshes::anySoup();
  const double halfWidth = *rc::gen::element(1.0, 3.0, 9.0);
  nano::HostTwin twin;
  expectSame(twin, mesh, bandOf(mesh, {}, halfWidth), levelSetJobFor({}, halfWidth));
}

} // namespace
