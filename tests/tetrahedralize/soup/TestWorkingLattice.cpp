// SPDX-License-Identifier: Apache-2.0
#include "ExactVolume.h"
#include "tetvdb/geometry/Exact.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace tetvdb {
namespace {

Box boxAt(const Vec3d& low, const Vec3d& high) {
  Box box;
  box.add(low);
  box.add(high);
  return box;
}

// Boxes near and far, large and small, cubes and needles.
std::vector<Box> boxes() {
  return {boxAt({0, 0, 0}, {1, 1, 1}),
          boxAt({-3, 5, 7}, {-2.9, 5.1, 7.3}),
          boxAt({1e8, -1e8, 1e8}, {1e8 + 1, -1e8 + 1, 1e8 + 1}),
          boxAt({0, 0, 0}, {1e-8, 2e-8, 1e-9}),
          boxAt({-1e8, -2e8, 0}, {1e8, 2e8, 1}),
          boxAt({0, 0, 0}, {1, 1, 1000}),
          boxAt({1e300, 0, 0}, {1.1e300, 1, 1}),
          boxAt({0, 0, 0}, {1e-200, 1e-200, 0})};
}

Vec3d within(const Box& box, std::mt19937_64& random, double margin) {
  std::uniform_real_distribution<double> along(-margin, 1 + margin);
  Vec3d p{};
  double side = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    side = std::max(side, box.high[axis] - box.low[axis]);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double midpoint = box.low[axis] / 2 + box.high[axis] / 2;
    p[axis] = midpoint + (along(random) - 0.5) * side;
  }
  return p;
}

TEST(WorkingLattice, UnitsArePowersOfTwo) {
  for (const Box& box : boxes()) {
    int exponent = 0;
    EXPECT_EQ(std::frexp(WorkingLattice(box).unit(), &exponent), 0.5);
  }
}

TEST(WorkingLattice, PointsAreWholeAndNearAndWithinBounds) {
  std::mt19937_64 random(1);
  for (const Box& box : boxes()) {
    const WorkingLattice lattice(box);
    for (int i = 0; i < 1000; ++i) {
      const Vec3d p = within(box, random, 0.5);
      const Vec3d on = lattice.toLattice(p);
      const Vec3d back = lattice.toWorld(on);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(on[axis], std::nearbyint(on[axis]));
        EXPECT_LE(std::abs(on[axis]), kLatticeBound);
        EXPECT_LE(std::abs(back[axis] - p[axis]), lattice.unit() / 2);
      }
    }
  }
}

TEST(WorkingLattice, TheWayBackRoundsNothing) {
  std::mt19937_64 random(2);
  std::uniform_int_distribution<std::int64_t> anywhere(-(std::int64_t(1) << 47) + 1,
                                                       (std::int64_t(1) << 47) - 1);
  for (const Box& box : boxes()) {
    const WorkingLattice lattice(box);
    const Vec3d origin = lattice.toWorld({0, 0, 0});
    for (int i = 0; i < 1000; ++i) {
      const Vec3d on{double(anywhere(random)), double(anywhere(random)), double(anywhere(random))};
      const Vec3d world = lattice.toWorld(on);
      EXPECT_EQ(lattice.toLattice(world), on);
      // Differences in world space are the lattice's, exactly: by whole numbers
      // of any length.
      for (std::size_t axis = 0; axis < 3; ++axis) {
        using exact_volume::Whole;
        const int unit = std::ilogb(lattice.unit());
        const Whole rest =
            Whole(world[axis], unit) - Whole(origin[axis], unit) - Whole(on[axis], 0);
        EXPECT_EQ(rest.sign(), 0);
      }
    }
  }
}

TEST(WorkingLattice, IsFineEnough) {
  for (const Box& box : boxes()) {
    double side = 0, far = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      side = std::max(side, box.high[axis] - box.low[axis]);
      far = std::max({far, std::abs(box.low[axis]), std::abs(box.high[axis])});
    }
    EXPECT_LE(WorkingLattice(box).unit(), std::max(side * 0x1p-46, (far + side) * 0x1p-50));
  }
}

// What delaunayTets() needs of points, and no more than is lost anyway far off.
TEST(WorkingLattice, CoarsePointsHave38Bits) {
  for (const Box& box : boxes()) {
    const WorkingLattice lattice(box);
    EXPECT_EQ(std::exp2(std::ilogb(lattice.coarse())), lattice.coarse());
    EXPECT_GE(lattice.coarse(), 1);
    double side = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      side = std::max(side, box.high[axis] - box.low[axis]);
    const double steps = side / lattice.unit() / lattice.coarse();
    EXPECT_LE(steps, 0x1p37);
    EXPECT_GT(steps, lattice.coarse() > 1 ? 0x1p35 : 0);
  }
}

// Small ones fit 128 bits; scaled by powers of two they carry through all of the digits.
TEST(LatticeOrientation, TheDeterminantIsTheExactOneRounded) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 2000; ++i) {
    const double size = std::ldexp(1.0, 1 + i % 24);
    std::uniform_real_distribution<double> along(-size, size);
    std::array<Vec3d, 4> p;
    for (Vec3d& q : p)
      q = roundToLattice({along(random), along(random), along(random)});
    Int128 d[3][3];
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        d[k][axis] = static_cast<std::int64_t>(p[k + 1][axis] - p[0][axis]);
    const Int128 whole = d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) -
                         d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
                         d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
    for (const double scale : {1.0, 0x1p11, 0x1p22}) {
      const double expected = static_cast<double>(whole) * scale * scale * scale;
      EXPECT_NEAR(exactDeterminant(times(p[0], scale), times(p[1], scale), times(p[2], scale),
                                   times(p[3], scale)),
                  expected, std::abs(expected) * 0x1p-51);
    }
  }
}

void expectSign(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  // Both count where d lies on the side that (b - a) x (c - a) points to.
  const int expected = exact_volume::signByWholes({a[0], a[1], a[2]}, {b[0], b[1], b[2]},
                                                  {c[0], c[1], c[2]}, {d[0], d[1], d[2]});
  ASSERT_EQ(latticeOrientation(a, b, c, d), expected);
  ASSERT_EQ(signOf(exactDeterminant(a, b, c, d)), expected);
  ASSERT_EQ(latticeOrientation(b, a, c, d), -expected);
}

TEST(LatticeOrientation, IsExactForRandomTets) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 4000; ++i) {
    // From a few units to the whole lattice.
    const double size = std::ldexp(1.0, 2 + i % 46);
    std::uniform_real_distribution<double> along(-size, size);
    std::array<Vec3d, 4> p;
    for (Vec3d& q : p)
      q = roundToLattice({along(random), along(random), along(random)});
    expectSign(p[0], p[1], p[2], p[3]);
  }
}

// The fourth point on the others' plane, up to rounding to the lattice or a
// unit aside.
TEST(LatticeOrientation, IsExactNearPlanes) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> along(-kLatticeBound, kLatticeBound);
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  int zeros = 0, signs = 0;
  for (int i = 0; i < 4000; ++i) {
    std::array<Vec3d, 4> p;
    for (Vec3d& q : p)
      q = roundToLattice({along(random), along(random), along(random)});
    const double s = share(random) / 2, t = share(random) / 2;
    for (std::size_t axis = 0; axis < 3; ++axis)
      p[3][axis] = std::nearbyint(p[0][axis] * (1 - s - t) + p[1][axis] * s + p[2][axis] * t);
    if (i % 3 == 0) // on the plane: the corner of a parallelogram of even numbers
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t k = 0; k < 3; ++k)
          p[k][axis] = std::nearbyint(p[k][axis] / 8) * 2;
        p[3][axis] = p[1][axis] + p[2][axis] - p[0][axis] + (i % 2 == 0 && axis == 1 ? 1 : 0);
      }
    expectSign(p[0], p[1], p[2], p[3]);
    const int sign = latticeOrientation(p[0], p[1], p[2], p[3]);
    (sign == 0 ? zeros : signs) += 1;
  }
  EXPECT_GT(zeros, 500);
  EXPECT_GT(signs, 500);
}

TEST(LatticeOrientation, IsExactAtTheCornersOfTheLattice) {
  std::vector<Vec3d> corners;
  const double maxValue = kLatticeBound - 1;
  for (int i = 0; i < 8; ++i)
    corners.push_back({(i & 1) != 0 ? maxValue : -maxValue, (i & 2) != 0 ? maxValue : -maxValue,
                       (i & 4) != 0 ? maxValue : -maxValue});
  corners.push_back({0, 0, 0});
  corners.push_back({1, 0, 0});
  for (const Vec3d& a : corners)
    for (const Vec3d& b : corners)
      for (const Vec3d& c : corners)
        for (const Vec3d& d : corners)
          expectSign(a, b, c, d);
}

} // namespace
} // namespace tetvdb
