// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/geometry/SolidAngle.h"
#include "tetvdb/geometry/VectorMath.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace tetvdb {
namespace {

using Long = std::array<long double, 3>;

// By the three angles between the planes through the sides (Girard), with the sign of the volume.
double byExcess(const std::array<Long, 3>& t) {
  const auto dot = [](const Long& a, const Long& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  };
  const auto cross = [](const Long& a, const Long& b) {
    return Long{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  long double excess = -3.14159265358979323846L;
  for (std::size_t i = 0; i < 3; ++i) {
    const Long u = cross(t[i], t[(i + 1) % 3]), v = cross(t[i], t[(i + 2) % 3]), w = cross(u, v);
    excess += std::atan2(std::sqrt(dot(w, w)), dot(u, v));
  }
  return static_cast<double>(dot(t[0], cross(t[1], t[2])) < 0 ? -excess : excess);
}

double byExcess(const SeenTriangle& t, const Long& p) {
  std::array<Long, 3> moved{};
  const Vec3d* corners[3] = {&t.a, &t.b, &t.c};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      moved[i][k] = (*corners[i])[k] - p[k];
  return byExcess(moved);
}

Vec3d anyPlace(meshes::Random& random, double size) {
  Vec3d p{};
  for (double& c : p)
    c = std::round(random.between(-size, size));
  return p;
}

TEST(SolidAngle, OfTrianglesAnywhere) {
  meshes::Random random(1);
  for (int i = 0; i < 300; ++i) {
    const SeenTriangle t{anyPlace(random, 1e7), anyPlace(random, 1e7), anyPlace(random, 1e7)};
    std::vector<double> x, y, z;
    for (int k = 0; k < 61; ++k) {
      const Vec3d p = anyPlace(random, 2e7);
      x.push_back(p[0]);
      y.push_back(p[1]);
      z.push_back(p[2]);
    }
    std::vector<double> sums(x.size(), 7), far(x.size(), 7);
    addSolidAngles(t, 3, {x.data(), y.data(), z.data(), sums.data(), x.size()});
    addFarSolidAngles(t, 3, 1e7, {x.data(), y.data(), z.data(), far.data(), x.size()});
    for (std::size_t k = 0; k < x.size(); ++k) {
      const double expected = byExcess(t, {x[k], y[k], z[k]});
      EXPECT_NEAR((sums[k] - 7) / 3, expected, 1e-9);
      const Vec3d p{x[k], y[k], z[k]};
      SeenTriangle seen = t;
      for (Vec3d* q : {&seen.a, &seen.b, &seen.c})
        for (std::size_t a = 0; a < 3; ++a)
          (*q)[a] -= p[a];
      EXPECT_NEAR(solidAngle(seen), expected, 1e-9);
      if (std::abs(expected) < 3) {
        EXPECT_NEAR((far[k] - 7) / 3, expected, 2e-5);
      }
    }
  }
}

// From points in the plane, on edges and at corners: as from the point moved by (e, e^2, e^3).
TEST(SolidAngle, TiesGoToTheSideOfTheMovedPoint) {
  meshes::Random random(2);
  const double scale = 0x1p34;
  int onTriangle = 0;
  for (int i = 0; i < 4000; ++i) {
    SeenTriangle t{anyPlace(random, 3), anyPlace(random, 3), anyPlace(random, 3)};
    if (i % 3 == 0) // in a plane across an axis
      t.a[std::size_t(i / 3 % 3)] = t.b[std::size_t(i / 3 % 3)] = t.c[std::size_t(i / 3 % 3)] = 0;
    SeenTriangle large = t;
    for (Vec3d* q : {&large.a, &large.b, &large.c})
      for (double& c : *q)
        c *= scale;
    const Vec3d normal = cross(minus(t.b, t.a), minus(t.c, t.a));
    const bool flat = normal == Vec3d{0, 0, 0};
    const double expected = flat ? 0 : byExcess(large, {0x1p22L, 0x1p11L, 1});
    const double exact = solidAngle(t);
    EXPECT_NEAR(exact, expected, 0.01)
        << i << ": " << t.a[0] << ' ' << t.a[1] << ' ' << t.a[2] << ", " << t.b[0] << ' ' << t.b[1]
        << ' ' << t.b[2] << ", " << t.c[0] << ' ' << t.c[1] << ' ' << t.c[2];
    const double zero = 0;
    double sum = 0;
    addSolidAngles(t, 1, {&zero, &zero, &zero, &sum, 1});
    EXPECT_NEAR(sum, exact, 1e-9);
    onTriangle += std::abs(exact) > 6;
  }
  EXPECT_GT(onTriangle, 20);
}

TEST(SolidAngle, CrossingsBelow) {
  const SeenTriangle up{{-2, -2, -1}, {2, -2, -1}, {0, 3, -1}};
  const SeenTriangle down{up.a, up.c, up.b};
  EXPECT_EQ(crossingBelow(up), -1);
  EXPECT_EQ(crossingBelow(down), 1);
  for (const double z : {-1.0, 0.0, 1.0}) {
    const SeenTriangle moved{{-2, -2, z}, {0, 3, z}, {2, -2, z}};
    EXPECT_EQ(crossingBelow(moved), z <= 0 ? 1 : 0); // moved up from a plane through 0
  }
  EXPECT_EQ(crossingBelow({{1, 1, -1}, {3, 1, -1}, {2, 4, -1}}), 0);
  EXPECT_EQ(crossingBelow({{0, -2, -1}, {0, 2, -1}, {0, 0, 5}}), 0); // upright
}

} // namespace
} // namespace tetvdb
