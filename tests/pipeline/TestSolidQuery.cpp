// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/pipeline/SolidQuery.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

std::vector<Vec3d> randomPoints(std::size_t count, double reach, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  std::vector<Vec3d> points(count);
  for (Vec3d& p : points)
    p = {coordinate(generator), coordinate(generator), coordinate(generator)};
  return points;
}

std::vector<std::uint8_t> insideOf(const TriangleMesh& mesh, const std::vector<Vec3d>& points) {
  Progress progress;
  std::vector<std::uint8_t> inside(points.size());
  SolidQuery(mesh, progress).at(points.data(), points.size(), inside.data(), nullptr, progress);
  return inside;
}

TEST(SolidQuery, windingNumberOfAClosedMesh) {
  const TriangleMesh mesh = sphere({0, 0, 0}, 1, 8);
  const std::vector<Vec3d> points = randomPoints(2000, 1.4, 3);
  const std::vector<std::uint8_t> inside = insideOf(mesh, points);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_EQ(inside[i] != 0, windingNumberAt(mesh, points[i]) > 0.5) << i;
}

TEST(SolidQuery, windingNumberOfAnOpenMesh) {
  TriangleMesh mesh = sphere({0, 0, 0}, 1, 8);
  mesh.triangles.resize(mesh.triangles.size() / 3 / 4 * 3 * 3); // a quarter is gone
  const std::vector<Vec3d> points = randomPoints(2000, 1.4, 4);
  const std::vector<std::uint8_t> inside = insideOf(mesh, points);
  std::size_t sure = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double winding = windingNumberAt(mesh, points[i]);
    if (std::abs(winding - 0.5) < 2e-3)
      continue;
    ++sure;
    EXPECT_EQ(inside[i] != 0, winding > 0.5) << i;
  }
  EXPECT_GT(sure, 1900u);
}

TEST(SolidQuery, solidsThatFillSpaceShareTheirPointsOut) {
  std::vector<Vec3d> points;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 4; ++z)
        points.push_back({x / 2.0, y / 2.0, z / 2.0});
  std::vector<int> owners(points.size(), 0);
  for (int x = -1; x < 3; ++x)
    for (int y = -1; y < 3; ++y)
      for (int z = -1; z < 3; ++z) {
        const Vec3d low{double(x), double(y), double(z)};
        const std::vector<std::uint8_t> inside =
            insideOf(box(low, plus(low, {1, 1, 1}), 2), points);
        for (std::size_t i = 0; i < points.size(); ++i)
          owners[i] += inside[i];
      }
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_EQ(owners[i], 1) << i;
}

TEST(SolidQuery, distanceToABox) {
  Progress progress;
  const SolidQuery query(box({-1, -1, -1}, {1, 1, 1}, 3), progress);
  EXPECT_EQ(query.openEdges(), 0u);
  const std::vector<Vec3d> points = randomPoints(2000, 2, 5);
  std::vector<double> distance(points.size());
  query.at(points.data(), points.size(), nullptr, distance.data(), progress);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double outside = 0, inside = -std::numeric_limits<double>::infinity();
    for (const double x : points[i]) {
      outside += std::pow(std::max(std::abs(x) - 1, 0.0), 2);
      inside = std::max(inside, std::abs(x) - 1);
    }
    EXPECT_NEAR(distance[i], inside < 0 ? inside : std::sqrt(outside), 1e-14) << i;
  }
}

TEST(SolidQuery, farFromTheOriginAndFromTheMesh) {
  const double far = 1e7;
  const std::vector<Vec3d> points = {
      {far + 0.5, 0.5, 0.5}, {far + 1.5, 0.5, 0.5}, {0, 0, 0}, {1e300, 0, 0}, {far, -1e30, 0.5}};
  const std::vector<std::uint8_t> inside = insideOf(box({far, 0, 0}, {far + 1, 1, 1}), points);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{1, 0, 0, 0, 0}));
}

TEST(SolidQuery, refusesWhatIsNoMeshAndNoPoint) {
  Progress progress;
  TriangleMesh bad = box();
  EXPECT_THROW(SolidQuery(TriangleMesh(), progress), Error);
  bad.triangles[4] = 8;
  EXPECT_THROW(SolidQuery(bad, progress), Error);
  const SolidQuery query(box(), progress);
  const Vec3d points[2] = {{0, 0, 0}, {0, std::nan(""), 0}};
  std::uint8_t inside[2];
  try {
    query.at(points, 2, inside, nullptr, progress);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Invalid);
    EXPECT_NE(std::string(error.what()).find("point 1"), std::string::npos);
  }
  query.at(points, 0, nullptr, nullptr, progress);
}

TEST(SolidQuery, isCancelled) {
  Progress progress;
  const SolidQuery query(box(), progress);
  progress.cancel();
  const Vec3d point{0.5, 0.5, 0.5};
  std::uint8_t inside = 0;
  EXPECT_THROW(query.at(&point, 1, &inside, nullptr, progress), Error);
}

} // namespace
} // namespace tetvdb
