// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/surface/WeldPoints.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

using Numbers = std::vector<std::uint32_t>;

Numbers weldNumbers(const std::vector<Vec3d>& points, double distance = 0) {
  Progress progress;
  return weldPoints(points, distance, progress);
}

double distanceOf(const Vec3d& a, const Vec3d& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

// As the header says it, one point after another.
Numbers weldPlainly(const std::vector<Vec3d>& points, double distance) {
  Numbers becomes;
  std::map<Vec3d, std::uint32_t> seen; // -0 and 0 are equivalent keys
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const auto [entry, isNew] = seen.try_emplace(points[i], i);
    if (!isNew) {
      becomes.push_back(becomes[entry->second]);
      continue;
    }
    std::uint32_t first = i;
    for (std::uint32_t j = 0; j < i && distance > 0 && first == i; ++j)
      if (becomes[j] == j && distanceOf(points[i], points[j]) < distance)
        first = j;
    becomes.push_back(first);
  }
  return becomes;
}

TEST(WeldPoints, EqualPointsBecomeTheFirst) {
  EXPECT_EQ(
      weldNumbers({{1, 2, 3}, {0.0, 1, 2}, {1, 2, 3}, {-0.0, 1, 2}, {1, 2, 3.0000000000000004}}),
      (Numbers{0, 1, 0, 1, 4}));
  EXPECT_EQ(weldNumbers({}), Numbers{});
}

TEST(WeldPoints, AgreesWithThePlainWay) {
  meshes::Random random(5);
  for (const double distance : {0.0, 0.01, 0.2, 1.0, 50.0}) {
    std::vector<Vec3d> points;
    for (int i = 0; i < 1500; ++i)
      points.push_back({random.between(-3, 3), std::floor(random.between(-3, 3)),
                        std::floor(random.between(-2, 2)) / 8});
    for (int i = 0; i < 1500; ++i)
      points.push_back(points[random.below(points.size())]);
    EXPECT_EQ(weldNumbers(points, distance), weldPlainly(points, distance)) << distance;
  }
}

TEST(WeldPoints, ManyPointsAndManyEqual) {
  std::vector<Vec3d> points;
  meshes::Random random(6);
  for (int i = 0; i < 200000; ++i)
    points.push_back({std::floor(random.between(0, 40)), std::floor(random.between(0, 40)), 7});
  const Numbers expected = weldPlainly(points, 0);
  for (const int threads : {1, 4})
    tbb::task_arena(threads).execute([&] { EXPECT_EQ(weldNumbers(points), expected); });
  const std::vector<Vec3d> one(100000, Vec3d{1, 2, 3});
  EXPECT_EQ(weldNumbers(one, 0.5), Numbers(one.size(), 0));
}

TEST(WeldPoints, DistanceBelowTheResolutionWeldsNoMoreThanEqualPoints) {
  const std::vector<Vec3d> points{{1e9, 0, 0}, {1e9, 0, 0}, {1e9, 1e-300, 0}, {-1e9, 0, 0}};
  EXPECT_EQ(weldNumbers(points, 1e-310), (Numbers{0, 0, 2, 3}));
}

} // namespace
} // namespace tetvdb
