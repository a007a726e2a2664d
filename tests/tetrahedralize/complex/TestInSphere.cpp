// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/tetrahedralize/complex/InSphere.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace tetvdb {
namespace {

// Points with whole coordinates on the sphere of radius 39 around (0, 0, 0).
std::vector<Vec3d> wholeSphere() {
  std::vector<Vec3d> sphere;
  for (int x = -39; x <= 39; ++x)
    for (int y = -39; y <= 39; ++y)
      for (int z = -39; z <= 39; ++z)
        if (x * x + y * y + z * z == 39 * 39)
          sphere.push_back({1.0 * x, 1.0 * y, 1.0 * z});
  return sphere;
}

TEST(InSphere, OneUnitFromASphereInTheWholeLattice) {
  const std::vector<Vec3d> sphere = wholeSphere();
  ASSERT_GT(sphere.size(), 50u);
  meshes::Random random(1);
  int judged = 0;
  for (int round = 0; round < 20000; ++round) {
    // A whole multiple and shift keep what is on the sphere on it.
    const double scale = std::floor(std::exp2(random.between(0, 31)));
    const Vec3d shift = {std::floor(random.between(-0x1p36, 0x1p36)),
                         std::floor(random.between(-0x1p36, 0x1p36)),
                         std::floor(random.between(-0x1p36, 0x1p36))};
    std::array<Vec3d, 5> q{};
    Vec3d fifth{};
    for (Vec3d& p : q) {
      fifth = sphere[random.below(sphere.size())];
      for (std::size_t axis = 0; axis < 3; ++axis)
        p[axis] = shift[axis] + scale * fifth[axis];
    }
    const int side = latticeOrientation(q[0], q[1], q[2], q[3]);
    if (side == 0)
      continue;
    if (side < 0)
      std::swap(q[0], q[1]);
    EXPECT_FALSE(liesInSphere(q[0], q[1], q[2], q[3], q[4]));
    const std::size_t axis = random.below(3);
    if (fifth[axis] == 0)
      continue;
    // With |x| <= 39 scale, a unit towards the centre's plane is a unit into the ball, as long as
    // it does not pass through.
    ++judged;
    const double inward = fifth[axis] > 0 ? -1 : 1;
    Vec3d p = q[4];
    p[axis] += inward;
    EXPECT_TRUE(liesInSphere(q[0], q[1], q[2], q[3], p));
    EXPECT_TRUE(liesInSphereExactly(q[0], q[1], q[2], q[3], p));
    p[axis] -= 2 * inward;
    EXPECT_FALSE(liesInSphere(q[0], q[1], q[2], q[3], p));
    EXPECT_FALSE(liesInSphereExactly(q[0], q[1], q[2], q[3], p));
  }
  EXPECT_GT(judged, 10000);
}

TEST(InSphere, FilterAndExactSignAgree) {
  meshes::Random random(2);
  for (int round = 0; round < 200000; ++round) {
    const double extent = std::exp2(random.between(1, 37));
    std::array<Vec3d, 5> q{};
    for (Vec3d& p : q) {
      const double own = random.unit() < 0.3 ? 5 : extent; // some near the origin
      for (double& x : p)
        x = std::floor(random.between(-own, own));
    }
    const int side = latticeOrientation(q[0], q[1], q[2], q[3]);
    if (side == 0)
      continue;
    if (side < 0)
      std::swap(q[0], q[1]);
    EXPECT_EQ(liesInSphere(q[0], q[1], q[2], q[3], q[4]),
              liesInSphereExactly(q[0], q[1], q[2], q[3], q[4]));
  }
}

TEST(InSphere, LargestDifferences) {
  constexpr double kTop = 0x1p37 - 1;
  // The box's eight corners are cospherical.
  const Vec3d a = {-kTop, -kTop, -kTop}, b = {kTop, -kTop, -kTop}, c = {-kTop, kTop, -kTop},
              d = {-kTop, -kTop, kTop};
  ASSERT_EQ(latticeOrientation(a, b, c, d), 1);
  EXPECT_FALSE(liesInSphere(a, b, c, d, {kTop, kTop, kTop}));
  EXPECT_FALSE(liesInSphere(a, b, c, d, {kTop, kTop, -kTop}));
  EXPECT_TRUE(liesInSphere(a, b, c, d, {kTop, kTop, kTop - 1}));
  EXPECT_TRUE(liesInSphere(a, b, c, d, {kTop, kTop - 1, -kTop}));
  EXPECT_FALSE(liesInSphere(a, b, c, d, {kTop, -kTop - 1, -kTop}));
}

} // namespace
} // namespace tetvdb
