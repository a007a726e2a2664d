// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/surface/CubeRegions.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <map>

namespace tetvdb {
namespace {

std::vector<Vec3d> somePoints(std::size_t count) {
  meshes::Random random(5);
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back({random.between(-2, 2), random.between(-2, 2), random.between(-2, 2)});
  return points;
}

TEST(CubeRegions, PointsOfOneCubeAreARegionNumberedByItsFirstPoint) {
  const std::vector<Vec3d> points = somePoints(20000);
  const CubeRegions regions = divideByCubes(points, points.size(), 0.7, 0.25);
  std::map<std::array<long, 3>, std::uint32_t> numbers;
  for (std::size_t v = 0; v < points.size(); ++v) {
    std::array<long, 3> cube{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      cube[axis] = std::lround(std::floor(points[v][axis] / 0.7 + 0.25));
    const auto next = static_cast<std::uint32_t>(numbers.size());
    ASSERT_EQ(regions.regionOf[v], numbers.emplace(cube, next).first->second) << v;
  }
  EXPECT_EQ(regions.count, numbers.size());
  EXPECT_GT(regions.count, 100U);
}

TEST(CubeRegions, OnlyTheFirstPointsAndOneRegionForAnInfiniteSide) {
  const std::vector<Vec3d> points = somePoints(100);
  EXPECT_EQ(divideByCubes(points, 40, 1, 0).regionOf.size(), 40U);
  const CubeRegions one = divideByCubes(points, 100, std::numeric_limits<double>::infinity(), 0.5);
  EXPECT_EQ(one.regionOf, std::vector<std::uint32_t>(100, 0));
  EXPECT_EQ(one.count, 1U);
  EXPECT_EQ(divideByCubes({}, 0, 1, 0).count, 0U);
}

TEST(CubeRegions, MeanEdge) {
  const std::vector<Vec3d> points{{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {0, 0, 4}};
  EXPECT_DOUBLE_EQ(meanEdge(points, {0, 1, 2}), 4);
  EXPECT_DOUBLE_EQ(meanEdge(points, {0, 1, 2, 3, 1, 0}), 4); // 3, 5, 4 and 5, 3, 4
}

} // namespace
} // namespace tetvdb
