// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/geometry/Orientation.h"

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace tetvdb {
namespace {

using boost::multiprecision::cpp_rational;
using meshes::Random;

// By rational numbers: every double is one.
int oracle(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  cpp_rational m[3][3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    m[0][axis] = cpp_rational(b[axis]) - cpp_rational(a[axis]);
    m[1][axis] = cpp_rational(c[axis]) - cpp_rational(a[axis]);
    m[2][axis] = cpp_rational(d[axis]) - cpp_rational(a[axis]);
  }
  const cpp_rational determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                                   m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                                   m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return determinant.sign();
}

int oracle(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  return oracle({a[0], a[1], 0}, {b[0], b[1], 0}, {a[0], a[1], -1}, {c[0], c[1], 0});
}

TEST(Orientation, SignsAreAsTheHeaderSays) {
  EXPECT_EQ(orientation(Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}), 1);
  EXPECT_EQ(orientation(Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{9, 9, -1e-300}), -1);
  EXPECT_EQ(orientation(Vec3d{0, 0, 5}, Vec3d{1, 0, 5}, Vec3d{0, 1, 5}, Vec3d{7, 3, 5}), 0);
  EXPECT_EQ(orientation(Vec2d{0, 0}, Vec2d{1, 0}, Vec2d{0, 1}), 1);
  EXPECT_EQ(orientation(Vec2d{0, 0}, Vec2d{0, 1}, Vec2d{1, 0}), -1);
  EXPECT_EQ(orientation(Vec2d{0, 0}, Vec2d{3, 1}, Vec2d{6, 2}), 0);
  EXPECT_EQ(oracle(Vec2d{0, 0}, Vec2d{1, 0}, Vec2d{0, 1}), 1);
}

int signInDoubles(const std::array<Vec3d, 4>& p) {
  double m[3][3];
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t axis = 0; axis < 3; ++axis)
      m[row][axis] = p[row + 1][axis] - p[0][axis];
  const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return (determinant > 0) - (determinant < 0);
}

// Points near a plane: what decides lies in the last bits, or is nothing.
TEST(Orientation, AgreesWithRationalNumbersNearPlanes) {
  Random random(1);
  int wrongInDoubles = 0;
  for (int round = 0; round < 20000; ++round) {
    const double offset = round % 3 == 0 ? 0 : round % 3 == 1 ? 1e3 : 1e8;
    const double scale = std::ldexp(1.0, static_cast<int>(random.below(200)) - 100);
    std::array<Vec3d, 4> p;
    for (std::size_t k = 0; k < 3; ++k)
      for (double& coordinate : p[k])
        coordinate = scale * (offset + random.between(-1, 1));
    const double s = random.between(-2, 2), t = random.between(-2, 2);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      p[3][axis] = p[0][axis] + s * (p[1][axis] - p[0][axis]) + t * (p[2][axis] - p[0][axis]);
      const std::size_t nudge = random.below(4);
      for (std::size_t i = 1; i < nudge; ++i)
        p[3][axis] = std::nextafter(p[3][axis], std::numeric_limits<double>::infinity());
    }
    const int expected = oracle(p[0], p[1], p[2], p[3]);
    wrongInDoubles += signInDoubles(p) != expected;
    ASSERT_EQ(orientation(p[0], p[1], p[2], p[3]), expected);
    ASSERT_EQ(orientation(p[1], p[0], p[2], p[3]), -expected);
    ASSERT_EQ(orientation(p[3], p[2], p[1], p[0]), expected);
    const Vec2d a{p[0][0], p[0][1]}, b{p[1][0], p[1][1]};
    const Vec2d c{a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])};
    ASSERT_EQ(orientation(a, b, c), oracle(a, b, c));
  }
  EXPECT_GT(wrongInDoubles, 1000);
}

TEST(Orientation, AgreesWithRationalNumbersForWildMagnitudes) {
  Random random(2);
  for (int round = 0; round < 20000; ++round) {
    std::array<Vec3d, 4> p;
    for (Vec3d& q : p)
      for (double& coordinate : q)
        coordinate = random.below(5) == 0 ? 0
                                          : std::ldexp(random.between(-1, 1),
                                                       static_cast<int>(random.below(240)) - 120);
    ASSERT_EQ(orientation(p[0], p[1], p[2], p[3]), oracle(p[0], p[1], p[2], p[3]));
  }
}

// Small whole numbers: many points in one plane or on one line.
TEST(Orientation, AgreesWithRationalNumbersOnGrids) {
  Random random(3);
  for (int round = 0; round < 20000; ++round) {
    std::array<Vec3d, 4> p;
    for (Vec3d& q : p)
      for (double& coordinate : q)
        coordinate = (static_cast<double>(random.below(5)) - 2) / (round % 2 ? 3.0 : 1.0);
    ASSERT_EQ(orientation(p[0], p[1], p[2], p[3]), oracle(p[0], p[1], p[2], p[3]));
    const bool collinear = [&] {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
        if (oracle(Vec2d{p[0][i], p[0][j]}, Vec2d{p[1][i], p[1][j]}, Vec2d{p[2][i], p[2][j]}) != 0)
          return false;
      }
      return true;
    }();
    ASSERT_EQ(areCollinear(p[0], p[1], p[2]), collinear);
  }
}

} // namespace
} // namespace tetvdb
