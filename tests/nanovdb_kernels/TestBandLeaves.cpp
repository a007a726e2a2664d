// SPDX-License-Identifier: Apache-2.0
#include "BandCases.h"
#include "fields/BruteDistance.h"
#include "nanovdb_kernels/AnySoup.h"
#include "nanovdb_kernels/BandLeaves.h"
#include "nanovdb_kernels/DeviceVoxelizer.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace {

using namespace tetvdb;
using meshes::kuhnGrid;

BandRasterizer twin(int shares) {
  return rasterizerBy([shares](const nano::DistanceJob& job, nano::DistanceReceiver& receiver) {
    nano::HostTwin().distances(job, receiver, shares);
  });
}

void expectSame(const BandCase& band, int shares = 1) {
  EXPECT_EQ(levelSetHash(band, twin(shares)), levelSetHash(band, rasterizeBand));
}

Vec3d turned(const Vec3d& p) {
  const double c = std::cos(0.37), s = std::sin(0.37);
  const Vec3d q{c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]};
  return {q[0], c * q[1] - s * q[2], s * q[1] + c * q[2]};
}

// Every voxel of the band's box, against distances that share no code with the library's.
void expectTrue(const BandCase& band) {
  Progress progress;
  const DistanceBand placed(band.mesh, band.faces, band.halfWidth, progress);
  CollectedBand found(placed);
  nano::HostTwin().distances(distanceJobFor(placed), found);
  for (const int times : found.taken)
    ASSERT_EQ(times, 1);

  const double unit = double(kUnitsPerVoxel);
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < band.mesh.pointCount; ++i)
    points.push_back(
        {band.mesh.points[i].x / unit, band.mesh.points[i].y / unit, band.mesh.points[i].z / unit});
  std::vector<std::uint32_t> corners;
  Vec3d low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
  for (const BoundaryFace& f : band.faces.faces)
    for (const std::uint32_t corner : {f.a, f.b, f.c}) {
      corners.push_back(corner);
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], points[corner][k]);
        high[k] = std::max(high[k], points[corner][k]);
      }
    }
  Vec3i first, last;
  for (std::size_t k = 0; k < 3; ++k) {
    first[k] = int(std::floor(low[k] - band.halfWidth)) - 1;
    last[k] = int(std::ceil(high[k] + band.halfWidth)) + 1;
  }
  std::uint64_t near = 0;
  int wrong = 0;
  for (int x = first[0]; x <= last[0]; ++x)
    for (int y = first[1]; y <= last[1]; ++y)
      for (int z = first[2]; z <= last[2]; ++z) {
        const double truth = double(oracle::distanceToAll(
            {(long double)x, (long double)y, (long double)z}, points, corners));
        const auto leaf = found.leaves.find({x & ~7, y & ~7, z & ~7});
        const double value =
            leaf == found.leaves.end()
                ? 1e9
                : std::sqrt(
                      double(leaf->second[std::size_t((x & 7) * 64 + (y & 7) * 8 + (z & 7))]));
        const bool right = truth < band.halfWidth - kDistanceError
                               ? std::abs(value - truth) <= kDistanceError
                               : value >= band.halfWidth - 2 * kDistanceError;
        near += truth < band.halfWidth;
        if (!right && ++wrong < 5)
          ADD_FAILURE() << x << ' ' << y << ' ' << z << ": " << value << ", expected " << truth;
      }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(near, 20u);
}

TEST(BandLeaves, TrueDistances) {
  expectTrue(bandOf(meshes::mapped(meshes::scaled(kuhnGrid(1, 1, 2), 9.3, {-70, 3, 60}), turned)));
  expectTrue(bandOf(meshes::scaled(kuhnGrid(2, 1, 1), 5, {0, -9, 124}), {}, 6.25));
  expectTrue(bandOf(meshes::soup(6, 14, 5, 3, 2), {}, 1));
}

// Far more than 64 faces to a leaf, which several teams share.
TEST(BandLeaves, TrueDistancesToManySmallFaces) {
  const TetMesh mesh =
      meshes::mapped(meshes::scaled(meshes::jittered(kuhnGrid(6, 6, 6), 0.2, 3), 0.9), turned);
  const BandCase band = bandOf(mesh, {}, 2);
  Progress progress;
  const DistanceBand placed(band.mesh, band.faces, 2, progress);
  EXPECT_GT(placed.nodeFaces().size(), 6 * nano::BandShared::kFaces);
  expectTrue(band);
  expectSame(band);
}

TEST(BandLeaves, TrueDistancesToSegmentsAndPoints) {
  expectTrue(
      bandOfFaces({{0.3, 0.2, 0.1}, {9.75, 4.25, -3.25}, {-6, 2, 3}, {12, 12, 12}, {12.5, 19, 12}},
                  {0, 1, 1, 2, 2, 2, 3, 4, 4}, 4));
}

TEST(BandLeaves, LatticeWhereEveryCentreIsATie) {
  for (int cell : {1, 3, 8})
    expectSame(bandOf(meshes::scaled(kuhnGrid(3, 3, 3), cell)));
}

TEST(BandLeaves, SeveralHalfWidthsAndShells) {
  const TetMesh mesh =
      meshes::mapped(meshes::scaled(kuhnGrid(2, 2, 2), 17, {-20, -130, 3}), turned);
  for (const double halfWidth : {1.0, 3.0, 6.5, 30.0})
    expectSame(bandOf(mesh, {}, halfWidth));
  expectSame(bandOf(mesh, {}, 3, 4.75));
  expectSame(bandOf(mesh, {{0.37, 0.37, 0.37}, {0.1, -7, 300}}));
}

TEST(BandLeaves, OverlapsFlipsAndFlatTets) {
  expectSame(bandOf(meshes::soup(300, 40, 9, 1, 5)));
  expectSame(bandOf(meshes::rounded(meshes::soup(300, 20, 5, 2, 5), 0.5)));
}

TEST(BandLeaves, SliversAndTinyAndLargeFaces) {
  expectSame(
      bandOf(meshes::mapped(meshes::jittered(kuhnGrid(4, 4, 40), 0.2, 3), [](const Vec3d& p) {
        return Vec3d{p[0] * 11, p[1] * 9 + 3, p[2] * 1e-5 + 4};
      })));
  expectSame(bandOf(meshes::joined(meshes::soup(400, 100, 0.7, 7), meshes::soup(3, 100, 90, 8))));
  expectSame(
      bandOf(meshes::mapped(meshes::scaled(kuhnGrid(1, 1, 1), 420, {-40, -30, -20}), turned)));
}

// More leaves than a batch holds, in several nodes, and nodes that a batch has no leaf of.
TEST(BandLeaves, SeveralBatchesOfWholeNodes) {
  const BandCase band = bandOf(meshes::scaled(kuhnGrid(1, 1, 1), 380, {3.5, -70.25, 100.75}));
  Progress progress;
  const DistanceBand placed(band.mesh, band.faces, band.halfWidth, progress);
  CollectedBand found(placed);
  const std::uint64_t leaves = nano::HostTwin().distances(distanceJobFor(placed), found);
  EXPECT_GT(leaves, nano::BandLeaves<int>::kBatchLeaves);
  EXPECT_EQ(found.leaves.size(), leaves);
  EXPECT_GT(found.batches, 1);
  for (const int times : found.taken)
    ASSERT_EQ(times, 1);
  expectSame(band);
}

// More nodes than are looked at together: thin, and 140,000 voxels long.
TEST(BandLeaves, SeveralChunksOfNodes) {
  const BandCase band = bandOf(meshes::mapped(kuhnGrid(1, 1, 1), [](const Vec3d& p) {
    return Vec3d{p[0] * 140000 - 60000, p[1] * 2 + p[0] * 40, p[2] * 2 - 1};
  }));
  Progress progress;
  const DistanceBand placed(band.mesh, band.faces, band.halfWidth, progress);
  EXPECT_GT(placed.nodes().size(), nano::BandLeaves<int>::kChunkNodes);
  expectSame(band);
  expectSame(band, 3);
}

TEST(BandLeaves, SharesTakeEveryNodeOnce) {
  const BandCase band = bandOf(meshes::mapped(meshes::soup(60, 400, 25, 3, 2), [](const Vec3d& p) {
    return Vec3d{p[0] - 200, p[1] - 200, p[2] - 200};
  }));
  Progress progress;
  const DistanceBand placed(band.mesh, band.faces, band.halfWidth, progress);
  for (int shares : {2, 3, 7, 1000}) {
    CollectedBand found(placed);
    nano::HostTwin().distances(distanceJobFor(placed), found, shares);
    for (const int times : found.taken)
      ASSERT_EQ(times, 1);
  }
  for (int shares : {2, 3, 7})
    expectSame(band, shares);
}

TEST(BandLeaves, NoFaces) {
  expectSame(bandOf(meshes::scaled(kuhnGrid(1, 1, 1), 0.1, {0.5, 0.5, 0.5})));
  expectSame(bandOfFaces({}, {}));
}

RC_GTEST_PROP(BandLeavesProperties, Soups, ()) {
  const TetMesh mesh = meshes::anySoup();
  const double halfWidth = *rc::gen::element(1.0, 3.0, 9.0);
  const double shell = *rc::gen::element(0.0, 0.0, 1.5);
  expectSame(bandOf(mesh, {}, halfWidth, shell), *rc::gen::inRange(1, 4));
}

} // namespace
