// SPDX-License-Identifier: Apache-2.0
#include "MeshOracles.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/print/DrainHoles.h"
#include "tetvdb/surface/LocalRepair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <queue>
#include <set>

namespace tetvdb {
namespace {

// Whether places outside of the solid are connected with one another: by steps of `step` along the
// axes through places whose winding number is below a half.
bool areConnected(const TriangleMesh& mesh, const Vec3d& from, const Vec3d& to, double step,
                  double bound) {
  using Cell = std::array<int, 3>;
  const auto placeOf = [&](const Cell& c) {
    return Vec3d{from[0] + step * c[0], from[1] + step * c[1], from[2] + step * c[2]};
  };
  std::queue<Cell> open;
  std::set<Cell> seen{{0, 0, 0}};
  open.push({0, 0, 0});
  while (!open.empty()) {
    const Cell c = open.front();
    open.pop();
    const Vec3d p = placeOf(c);
    if (std::hypot(p[0] - to[0], p[1] - to[1], p[2] - to[2]) < step)
      return true;
    for (int i = 0; i < 6; ++i) {
      Cell next = c;
      next[static_cast<std::size_t>(i / 2)] += i % 2 == 0 ? 1 : -1;
      const Vec3d q = placeOf(next);
      if (std::abs(q[0]) > bound || std::abs(q[1]) > bound || std::abs(q[2]) > bound ||
          !seen.insert(next).second || meshes::windingNumberAt(mesh, q) > 0.5)
        continue;
      open.push(next);
    }
  }
  return false;
}

TriangleMesh hollowBox() {
  return meshes::joined({meshes::box({-10, -10, -10}, {10, 10, 10}, 3),
                         meshes::flipped(meshes::box({-8, -8, -8}, {8, 8, 8}, 5))});
}

void expectSolid(const TriangleMesh& mesh) {
  EXPECT_TRUE(oracles::isClosedManifold(mesh));
  Progress progress;
  EXPECT_EQ(whatIsBroken(mesh, progress), "");
}

TEST(DrainHoles, TakeAPrismOutOfTheWall) {
  TriangleMesh solid = hollowBox();
  const double before = meshes::signedVolume(solid);
  Progress progress;
  const DrilledHoles drilled = drillHoles(
      solid, {{{1.1, 2.3, -10}, {0, 0, 1}, 2}, {{10, -3.2, 1.7}, {-2, 0, 0}, 1}}, progress);
  const double first = kPi * 4 * 2, second = kPi * 2;
  EXPECT_NEAR(before - meshes::signedVolume(solid), first + second, 1e-6);
  ASSERT_EQ(drilled.plugs.size(), 2u);
  EXPECT_NEAR(meshes::signedVolume(drilled.plugs[0]), first, 1e-6);
  EXPECT_NEAR(meshes::signedVolume(drilled.plugs[1]), second, 1e-6);
  expectSolid(solid);
  for (const TriangleMesh& plug : drilled.plugs)
    expectSolid(plug);
  for (const Vec3d& p : drilled.plugs[0].points) {
    EXPECT_LE(p[2], -8 + 1e-9);
    EXPECT_LE(std::hypot(p[0] - 1.1, p[1] - 2.3), 2.01);
  }
}

TEST(DrainHoles, ConnectTheCavityWithTheOutside) {
  TriangleMesh solid = hollowBox();
  const Vec3d inside{0, 0, 0}, outside{11.5, 11.5, 11.5};
  EXPECT_FALSE(areConnected(solid, inside, outside, 0.5, 12));
  Progress progress;
  drillHoles(solid, {{{1.1, 2.3, -10}, {0, 0, 1}, 1}}, progress);
  EXPECT_TRUE(areConnected(solid, inside, outside, 0.5, 12));
}

TEST(DrainHoles, GoThroughSlantedWalls) {
  TriangleMesh solid = meshes::joined(
      {meshes::sphere({0, 0, 0}, 10, 16), meshes::flipped(meshes::sphere({0, 0, 0}, 8, 12))});
  const double before = meshes::signedVolume(solid);
  Progress progress;
  // Beside the middle: the wall's faces stand at 45 degrees to the axis.
  const DrilledHoles drilled = drillHoles(solid, {{{6.5, 0.1, -7.5}, {0, 0, 1}, 1.2}}, progress);
  expectSolid(solid);
  EXPECT_TRUE(areConnected(solid, {6.5, 0, -2}, {6.5, 0, -10}, 0.5, 11));
  EXPECT_NEAR(before - meshes::signedVolume(solid), meshes::signedVolume(drilled.plugs[0]), 1e-6);
  expectSolid(drilled.plugs[0]);
}

TEST(DrainHoles, LeaveFacesFarAwayAsTheyAre) {
  TriangleMesh solid = meshes::joined(
      {meshes::sphere({0, 0, 0}, 10, 40), meshes::flipped(meshes::sphere({0, 0, 0}, 8, 30))});
  const TriangleMesh before = solid;
  Progress progress;
  const DrilledHoles drilled = drillHoles(
      solid, {{{0.3, 0.2, -9}, {0, 0, 1}, 1}, {{9, 0.7, -0.4}, {-1, 0, 0}, 0.7}}, progress);
  expectSolid(solid);
  std::set<std::array<Vec3d, 3>> left;
  for (std::size_t face = 0; face < solid.triangleCount(); ++face)
    left.insert(oracles::cornersOf(solid, face));
  for (std::size_t face = 0; face < before.triangleCount(); ++face) {
    const auto corners = oracles::cornersOf(before, face);
    const bool isNear = std::any_of(corners.begin(), corners.end(), [](const Vec3d& p) {
      return std::hypot(p[0], p[1]) < 2 || std::hypot(p[1], p[2]) < 2;
    });
    EXPECT_TRUE(isNear || left.count(corners) > 0);
  }
  EXPECT_NEAR(meshes::signedVolume(before) - meshes::signedVolume(solid),
              meshes::signedVolume(drilled.plugs[0]) + meshes::signedVolume(drilled.plugs[1]),
              1e-6);
}

TEST(DrainHoles, AtTheLowestPointOfEveryCavity) {
  TriangleMesh solid = meshes::joined({meshes::box({-10, -10, -10}, {10, 10, 10}, 2),
                                       meshes::flipped(meshes::sphere({-4, 0, 0}, 3, 8)),
                                       meshes::flipped(meshes::box({2, -3, -6}, {8, 3, 6}))});
  const std::vector<DrainHole> holes = holesAtLowestPoints(solid, 0.8);
  ASSERT_EQ(holes.size(), 2u);
  EXPECT_NEAR(holes[0].point[0], -4, 1e-9);
  EXPECT_NEAR(holes[0].point[2], -3, 0.08); // a tenth of the radius
  EXPECT_EQ(holes[1].point, (Vec3d{5, 0, -6}));
  Progress progress;
  const DrilledHoles drilled = drillHoles(solid, holes, progress);
  expectSolid(solid);
  EXPECT_TRUE(areConnected(solid, {-4, 0, 0}, {-4, 0, -10.5}, 0.5, 11));
  EXPECT_TRUE(areConnected(solid, {5, 0, 0}, {5, 0, -10.5}, 0.5, 11));
  EXPECT_NEAR(meshes::signedVolume(drilled.plugs[0]), kPi * 0.64 * 7, 0.7); // round at its end
}

TEST(DrainHoles, AreRefusedWhereThereIsNoCavity) {
  Progress progress;
  for (const DrainHole& hole :
       {DrainHole{{0, 0, -10}, {0, 0, 1}, 1}, DrainHole{{50, 0, 0}, {0, 0, 1}, 1}}) {
    TriangleMesh solid = meshes::box({-10, -10, -10}, {10, 10, 10});
    const TriangleMesh before = solid;
    try {
      drillHoles(solid, {hole}, progress);
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), Status::Invalid);
    }
    EXPECT_EQ(solid.points, before.points);
  }
}

} // namespace
} // namespace tetvdb
