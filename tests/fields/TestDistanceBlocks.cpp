// SPDX-License-Identifier: Apache-2.0
#include "fields/BruteDistance.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/fields/DistanceBlocks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <map>
#include <mutex>
#include <random>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

struct Soup {
  std::vector<Vec3d> points;
  Boundary faces;

  void add(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const auto first = static_cast<std::uint32_t>(points.size());
    points.insert(points.end(), {a, b, c});
    faces.faces.push_back({first, first + 1, first + 2, 1});
  }
};

// Faces of all sizes, some of no area, in [0, side]^3.
Soup randomSoup(int count, double side, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, side), size(-1, 1);
  Soup soup;
  for (int i = 0; i < count; ++i) {
    const Vec3d a{place(random), place(random), place(random)};
    const double reach = side * std::pow(0.5, i % 8);
    const auto near = [&] {
      return Vec3d{a[0] + reach * size(random), a[1] + reach * size(random),
                   a[2] + reach * size(random)};
    };
    const Vec3d b = i % 11 == 0 ? a : near();
    soup.add(a, b, i % 7 == 0 ? b : near());
  }
  return soup;
}

using Leaves = std::map<Vec3i, std::vector<float>>;

Leaves distancesOf(const Soup& soup, const VoxelBox& box, int threads = 2) {
  Progress progress;
  const SnappedMesh mesh = snapPoints(soup.points, GridTransform(), progress);
  const DistanceBlocks blocks(mesh, soup.faces);
  Leaves leaves;
  std::mutex mutex;
  tbb::task_arena arena(threads);
  arena.execute([&] {
    blocks.rasterize(
        box,
        [&](const Vec3i& first, const float* squared) {
          const std::lock_guard<std::mutex> lock(mutex);
          EXPECT_TRUE(
              leaves.emplace(first, std::vector<float>(squared, squared + kVoxelsInLeaf)).second);
        },
        progress);
  });
  return leaves;
}

float at(const Leaves& leaves, const Vec3i& voxel) {
  const auto found = leaves.find({voxel[0] & ~7, voxel[1] & ~7, voxel[2] & ~7});
  if (found == leaves.end())
    return -1;
  return found->second[static_cast<std::size_t>(((voxel[0] & 7) * 8 + (voxel[1] & 7)) * 8 +
                                                (voxel[2] & 7))];
}

// Corners where the lattice of 2^-20 voxel has them.
std::vector<oracle::Point> snapped(const Soup& soup) {
  std::vector<oracle::Point> points;
  for (const Vec3d& p : soup.points) {
    oracle::Point q;
    for (std::size_t k = 0; k < 3; ++k)
      q[k] = std::nearbyint(static_cast<long double>(p[k]) * 1048576) / 1048576;
    points.push_back(q);
  }
  return points;
}

void expectExact(const Soup& soup, const VoxelBox& box, const Leaves& leaves, int step) {
  const std::vector<oracle::Point> points = snapped(soup);
  std::vector<std::size_t> corners(points.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = i;
  int wrong = 0;
  for (std::int32_t x = box.low[0]; x <= box.high[0]; x += step)
    for (std::int32_t y = box.low[1]; y <= box.high[1]; y += step)
      for (std::int32_t z = box.low[2]; z <= box.high[2]; z += step) {
        const long double truth = oracle::distanceToAll(
            {static_cast<long double>(x), static_cast<long double>(y), static_cast<long double>(z)},
            points, corners);
        const auto found = std::sqrt(static_cast<double>(at(leaves, {x, y, z})));
        // Single precision of the square.
        const double tolerance = 1e-6 + 6e-8 * static_cast<double>(truth);
        if (!(std::abs(found - static_cast<double>(truth)) <= tolerance) && ++wrong < 5)
          ADD_FAILURE() << x << " " << y << " " << z << ": " << found << ", not "
                        << static_cast<double>(truth);
      }
  EXPECT_EQ(wrong, 0);
}

TEST(DistanceBlocks, RandomSoupsAgainstBruteForce) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Soup soup = randomSoup(seed == 1 ? 3 : 120, 40, seed);
    const VoxelBox box{{-5, -3, 2}, {41, 38, 50}};
    expectExact(soup, box, distancesOf(soup, box), 3);
  }
}

TEST(DistanceBlocks, FarFromTheFacesAndAcrossNodes) {
  const Soup soup = randomSoup(60, 8, 4);
  const VoxelBox box{{-140, 90, -20}, {-100, 150, 10}};
  expectExact(soup, box, distancesOf(soup, box), 7);
}

// Against all voxels of the box.
TEST(DistanceBlocks, TheLargestDistance) {
  for (const unsigned seed : {5u, 6u, 7u, 8u}) {
    const Soup soup = randomSoup(seed == 5 ? 1 : 90, 40, seed);
    for (const VoxelBox& box :
         {VoxelBox{{-5, -3, 2}, {41, 38, 50}}, VoxelBox{{-140, 90, -20}, {-100, 150, 10}},
          VoxelBox{{3, 3, 3}, {3, 3, 3}}, VoxelBox{{120, 126, 127}, {128, 129, 131}}}) {
      const Leaves leaves = distancesOf(soup, box);
      float largest = 0;
      for (std::int32_t x = box.low[0]; x <= box.high[0]; ++x)
        for (std::int32_t y = box.low[1]; y <= box.high[1]; ++y)
          for (std::int32_t z = box.low[2]; z <= box.high[2]; ++z)
            largest = std::max(largest, at(leaves, {x, y, z}));
      Progress progress;
      const SnappedMesh mesh = snapPoints(soup.points, GridTransform(), progress);
      EXPECT_EQ(DistanceBlocks(mesh, soup.faces).largest(box, progress), largest) << seed;
    }
  }
}

TEST(DistanceBlocks, ManyFacesEquallyNear) {
  // A sphere around the box's middle: every face is as near to it as any other.
  Soup soup;
  constexpr int kRings = 24;
  const auto on = [&](int i, int j) {
    const double a = kPi * i / kRings, b = kPi * j / kRings;
    return Vec3d{16 + 14 * std::sin(a) * std::cos(b), 16 + 14 * std::sin(a) * std::sin(b),
                 16 + 14 * std::cos(a)};
  };
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < 2 * kRings; ++j) {
      soup.add(on(i, j), on(i + 1, j), on(i + 1, j + 1));
      soup.add(on(i, j), on(i + 1, j + 1), on(i, j + 1));
    }
  const VoxelBox box{{0, 0, 0}, {32, 32, 32}};
  expectExact(soup, box, distancesOf(soup, box), 4);
}

TEST(DistanceBlocks, EveryLeafOfTheBoxAndNoOther) {
  const Soup soup = randomSoup(5, 10, 6);
  const VoxelBox box{{-9, 7, 8}, {8, 8, 15}};
  const Leaves leaves = distancesOf(soup, box);
  std::vector<Vec3i> expected;
  for (const std::int32_t x : {-16, -8, 0, 8})
    for (const std::int32_t y : {0, 8})
      expected.push_back({x, y, 8});
  std::vector<Vec3i> found;
  for (const auto& leaf : leaves)
    found.push_back(leaf.first);
  EXPECT_EQ(found, expected);
}

TEST(DistanceBlocks, SameBitsForAnyOrderAndAnyThreads) {
  Soup soup = randomSoup(300, 30, 7);
  const VoxelBox box{{-8, -8, -8}, {39, 39, 39}};
  const Leaves first = distancesOf(soup, box, 1);
  std::mt19937 random(1);
  std::shuffle(soup.faces.faces.begin(), soup.faces.faces.end(), random);
  for (BoundaryFace& face : soup.faces.faces)
    std::swap(face.a, face.c);
  EXPECT_EQ(distancesOf(soup, box, 4), first);
}

} // namespace
} // namespace tetvdb
