// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/TriangulateLoop.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;
using Loop = std::vector<std::uint32_t>;

const EdgeTaken kNoneTaken = [](std::uint32_t, std::uint32_t) { return false; };

SpaceLoop loopOf(std::size_t n) {
  SpaceLoop loop;
  for (std::uint32_t i = 0; i < n; ++i)
    loop.points.push_back(i);
  loop.beyond.assign(n, SpaceLoop::kNone);
  return loop;
}

double areaOf(const std::vector<Vec3d>& points, const Loop& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    Vec3d u, v;
    for (std::size_t k = 0; k < 3; ++k) {
      u[k] = points[corners[i + 1]][k] - points[corners[i]][k];
      v[k] = points[corners[i + 2]][k] - points[corners[i]][k];
    }
    sum += std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                      u[0] * v[1] - u[1] * v[0]) /
           2;
  }
  return sum;
}

// Largest 1 - cosine between triangles that share an edge.
double bendOf(const std::vector<Vec3d>& points, const Loop& corners) {
  const auto normal = [&](std::size_t i) {
    Vec3d u, v;
    for (std::size_t k = 0; k < 3; ++k) {
      u[k] = points[corners[i + 1]][k] - points[corners[i]][k];
      v[k] = points[corners[i + 2]][k] - points[corners[i]][k];
    }
    Vec3d n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double size = std::hypot(n[0], n[1], n[2]);
    return Vec3d{n[0] / size, n[1] / size, n[2] / size};
  };
  double max = 0;
  for (std::size_t i = 0; i < corners.size(); i += 3)
    for (std::size_t j = 0; j < i; j += 3) {
      std::size_t common = 0;
      for (std::size_t k = 0; k < 9; ++k)
        common += corners[i + k / 3] == corners[j + k % 3];
      if (common < 2)
        continue;
      const Vec3d a = normal(i), b = normal(j);
      max = std::max(max, 1 - (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]));
    }
  return max;
}

// Of larger loops parts are chosen before what they border on is known.
TEST(TriangulateLoop, LeastBendOfFourPoints) {
  Random random(3);
  Progress progress;
  for (int round = 0; round < 40; ++round) {
    std::vector<Vec3d> points;
    for (std::size_t i = 0; i < 4; ++i)
      points.push_back(
          {std::cos(kPi * double(i) / 2), std::sin(kPi * double(i) / 2), random.unit()});
    Loop corners;
    ASSERT_TRUE(triangulateLoop(points, loopOf(4), kNoneTaken, corners, progress));
    ASSERT_EQ(corners.size(), 6u);
    EXPECT_NEAR(bendOf(points, corners),
                std::min(bendOf(points, {0, 1, 2, 0, 2, 3}), bendOf(points, {0, 1, 3, 1, 2, 3})),
                1e-8);
  }
}

TEST(TriangulateLoop, PlaneLoopsKeepTheirArea) {
  Progress progress;
  for (const std::size_t n : {5u, 60u, 500u}) {
    std::vector<Vec3d> points;
    for (std::size_t i = 0; i < n; ++i) {
      const double angle = 2 * kPi * double(i) / double(n);
      points.push_back({std::cos(angle), std::sin(angle), 0});
    }
    Loop corners;
    ASSERT_TRUE(triangulateLoop(points, loopOf(n), kNoneTaken, corners, progress));
    EXPECT_EQ(corners.size(), 3 * (n - 2));
    EXPECT_NEAR(areaOf(points, corners), double(n) / 2 * std::sin(2 * kPi / double(n)), 1e-9);
  }
}

TEST(TriangulateLoop, FacesBeyondDecide) {
  // A square bent by the same angle along either diagonal. The face beyond its first edge is steep,
  // and less so for one of them.
  const std::vector<Vec3d> points{{0, 0, 0}, {1, 0, 0.1}, {1, 1, 0}, {0, 1, 0.1}};
  Progress progress;
  for (const bool first : {true, false}) {
    SpaceLoop loop = loopOf(4);
    std::vector<Vec3d> all = points;
    all.push_back({0.5, -0.5, first ? 0.3 : -0.2});
    loop.beyond[0] = 4;
    Loop corners;
    ASSERT_TRUE(triangulateLoop(all, loop, kNoneTaken, corners, progress));
    EXPECT_EQ(std::count(corners.begin(), corners.end(), 0u), first ? 2 : 1);
  }
}

TEST(TriangulateLoop, AvoidsEdgesThatExist) {
  const std::vector<Vec3d> points{{0, 0, 0}, {1, 0, 0.3}, {1, 1, 0}, {0, 1, 0.3}};
  Progress progress;
  Loop corners;
  const EdgeTaken diagonal = [](std::uint32_t a, std::uint32_t b) { return a % 2 + b % 2 == 2; };
  ASSERT_TRUE(triangulateLoop(points, loopOf(4), diagonal, corners, progress));
  EXPECT_EQ(std::count(corners.begin(), corners.end(), 0u), 2);
  corners.clear();
  const EdgeTaken every = [](std::uint32_t, std::uint32_t) { return true; };
  EXPECT_FALSE(triangulateLoop(points, loopOf(4), every, corners, progress));
  EXPECT_TRUE(corners.empty());
}

} // namespace
} // namespace tetvdb
