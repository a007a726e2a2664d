// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/LatticePlane.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace tetvdb {
namespace {

Vec3d randomPoint(std::mt19937_64& random, std::uint64_t max) {
  return {double(random() % max), double(random() % max), double(random() % max)};
}

// By construction: all planes pass through one lattice point, which the corner is.
TEST(LatticePlane, CornersLieWhereTheyWereMade) {
  std::mt19937_64 random(3);
  int zero = 0;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const std::uint64_t max = std::uint64_t(1) << (3 + i % 38); // up to 2^40
    const Vec3d p = randomPoint(random, max);
    const auto through = [&] {
      return LatticePlane::through(p, randomPoint(random, max), randomPoint(random, max));
    };
    const LatticePlane a = through(), b = through(), c = through(), d = through();
    const double det =
        a.roundedN[0] * (b.roundedN[1] * c.roundedN[2] - b.roundedN[2] * c.roundedN[1]) +
        a.roundedN[1] * (b.roundedN[2] * c.roundedN[0] - b.roundedN[0] * c.roundedN[2]) +
        a.roundedN[2] * (b.roundedN[0] * c.roundedN[1] - b.roundedN[1] * c.roundedN[0]);
    double size = 1;
    for (const LatticePlane* plane : {&a, &b, &c})
      size *= std::hypot(plane->roundedN[0], plane->roundedN[1], plane->roundedN[2]);
    if (!(std::abs(det) > 1e-9 * size))
      continue; // may be dependent
    const PlaneCorner corner(a, b, c);
    EXPECT_EQ(corner.side(d), 0); // through p as well: exact, or it would be chance
    ++zero;
    const Vec3d found = corner.position();
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(found[k], p[k], 0x1p-6);
    // A plane that misses p: the lattice point's own side.
    const LatticePlane other = LatticePlane::through(
        randomPoint(random, max), randomPoint(random, max), randomPoint(random, max));
    EXPECT_EQ(corner.side(other), PlaneCorner(p).side(other));
    EXPECT_EQ(corner.side(other), other.side(p));
  }
  EXPECT_GT(zero, 2000);
}

TEST(LatticePlane, SidesAreDeterminants) {
  std::mt19937_64 random(4);
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const std::uint64_t max = 2 + i % 7; // many in the plane
    const Vec3d a = randomPoint(random, max), b = randomPoint(random, max),
                c = randomPoint(random, max), p = randomPoint(random, max);
    const auto term = [&](std::size_t x, std::size_t y, std::size_t z) {
      return (b[x] - a[x]) * (c[y] - a[y]) * (p[z] - a[z]);
    };
    const double det = term(0, 1, 2) + term(1, 2, 0) + term(2, 0, 1) - term(0, 2, 1) -
                       term(1, 0, 2) - term(2, 1, 0);
    EXPECT_EQ(LatticePlane::through(a, b, c).side(p), (det > 0) - (det < 0));
  }
}

TEST(LatticePlane, LiftedPointsLieInTheirPlane) {
  std::mt19937_64 random(5);
  constexpr std::uint64_t kMax = std::uint64_t(1) << 34;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d a = randomPoint(random, kMax), b = randomPoint(random, kMax),
                c = randomPoint(random, kMax);
    const LatticePlane plane = LatticePlane::through(a, b, c);
    const LatticePlane turned = LatticePlane::through(b, a, c);
    EXPECT_TRUE(plane.coincides(turned));
    EXPECT_FALSE(plane.coincides(LatticePlane::through(a, b, {c[0] + 1, c[1], c[2] + 2})));
    const auto u = static_cast<std::int64_t>(random() % (kMax << kFineBits));
    const auto v = static_cast<std::int64_t>(random() % (kMax << kFineBits));
    const LiftedPoint point(plane, plane.steepestAxis(), u, v);
    EXPECT_EQ(point.side(plane), 0);
    EXPECT_EQ(point.side(turned), 0);
    // Moved along its steepest axis by one, the plane leaves the point behind.
    Vec3d d = a, e = b, f = c;
    for (Vec3d* q : {&d, &e, &f})
      (*q)[plane.steepestAxis()] += 1;
    const int normal = signOf(plane.n[plane.steepestAxis()]);
    EXPECT_EQ(point.side(LatticePlane::through(d, e, f)), -normal);
  }
}

} // namespace
} // namespace tetvdb
