// SPDX-License-Identifier: Apache-2.0
//
// The solids of closed components are compared with boxes and cylinders by formulas, and with
// winding numbers by a sum of solid angles (SolidAngleOracle.h).
#include "SolidAngleOracle.h"
#include "TriangleMeshes.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CloseComponents.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

// What was there is there still, as it was.
ClosedComponents closed(TriangleMesh& mesh) {
  const TriangleMesh before = mesh;
  Progress progress;
  const ClosedComponents result = closeComponents(mesh, progress);
  EXPECT_TRUE(std::equal(before.points.begin(), before.points.end(), mesh.points.begin()));
  EXPECT_TRUE(std::equal(before.triangles.begin(), before.triangles.end(), mesh.triangles.begin()));
  std::size_t faces = 0, points = before.points.size();
  for (const FilledHole& hole : result.holes) {
    faces += hole.faces;
    points += hole.points;
  }
  EXPECT_EQ(result.faces, faces);
  EXPECT_EQ(mesh.triangleCount(), before.triangleCount() + faces);
  EXPECT_EQ(mesh.faceCount, mesh.triangleCount());
  EXPECT_EQ(mesh.points.size(), points);
  return result;
}

void expectOpen(TriangleMesh mesh) {
  EXPECT_EQ(closed(mesh).faces, 0u);
}

double windingNumber(const TriangleMesh& mesh, const Vec3d& p) {
  double sum = 0;
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face) {
    std::array<std::array<double, 3>, 3> v;
    for (std::size_t k = 0; k < 3; ++k)
      v[k] = minus(mesh.points[mesh.triangles[3 * face + k]], p);
    sum += test::solidAngle<double>(v);
  }
  return sum / static_cast<double>(test::kSphere);
}

// Without the side at low z.
TriangleMesh bottomless(const Vec3d& low, const Vec3d& high) {
  const TriangleMesh whole = box(low, high);
  return without(whole, [&](std::size_t face) {
    for (std::size_t k = 0; k < 3; ++k)
      if (whole.points[whole.triangles[3 * face + k]][2] != low[2])
        return false;
    return true;
  });
}

bool isIn(const Vec3d& p, const Vec3d& low, const Vec3d& high) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (p[axis] < low[axis] || p[axis] > high[axis])
      return false;
  return true;
}

TEST(CloseComponents, AnOpenBox) {
  TriangleMesh mesh = bottomless({0, 0, 0}, {1, 2, 3});
  const ClosedComponents result = closed(mesh);
  ASSERT_EQ(result.holes.size(), 1u);
  EXPECT_EQ(result.holes[0].edges, 4u);
  EXPECT_EQ(result.faces, 2u);
  EXPECT_NEAR(signedVolume(mesh), 6, 1e-14);
}

// A house without floor on a plate without bottom. The hole of one is over the faces of the other,
// whose winding number is negative there.
TEST(CloseComponents, WhatIsOverTheHolesOfOthersIsInside) {
  const Vec3d house[2] = {{2, 2, 0.25}, {8, 8, 3}}, plate[2] = {{0, 0, 0}, {10, 10, 0.2}};
  TriangleMesh mesh = joined({bottomless(house[0], house[1]), bottomless(plate[0], plate[1])});
  const TriangleMesh open = mesh;
  EXPECT_EQ(closed(mesh).holes.size(), 2u);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(-1, 11), z(-1, 4);
  std::size_t wrong = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d p{x(random), x(random), z(random)};
    const bool inside = isIn(p, house[0], house[1]) || isIn(p, plate[0], plate[1]);
    EXPECT_NEAR(windingNumber(mesh, p), inside ? 1 : 0, 1e-9);
    wrong += (windingNumber(open, p) > 0.5) != inside;
  }
  EXPECT_GT(wrong, 20u); // of the open mesh: why it is closed
}

TEST(CloseComponents, HolesThatAreNotPlane) {
  // Two sides of a box are missing. By itself it has the smooth surface of the winding number.
  const auto corner = [](double shift) {
    return without(box({shift, 0, 0}, {1 + shift, 1, 1}),
                   [](std::size_t face) { return face >= 4 && face % 4 >= 2; });
  };
  expectOpen(corner(0));
  TriangleMesh two = joined({corner(0), corner(5)});
  EXPECT_EQ(closed(two).holes.size(), 2u);
  EXPECT_NEAR(signedVolume(two), 2, 1e-14);
  // Three sides are too many: a third of the volume would be added.
  const auto half = [](double shift) {
    return without(box({shift, 0, 0}, {1 + shift, 1, 1}),
                   [](std::size_t face) { return face % 4 >= 2; });
  };
  expectOpen(joined({half(0), half(5)}));
}

TEST(CloseComponents, TubesByTheirLength) {
  const double area = 32 * std::sin(kPi / 32) * std::cos(kPi / 32); // of the polygon
  TriangleMesh mesh = cylinder(1, 20, 32, false);
  EXPECT_EQ(closed(mesh).holes.size(), 2u);
  EXPECT_NEAR(signedVolume(mesh), 20 * area, 1e-10);
  expectOpen(cylinder(1, 0.5, 32, false));
}

// The walls of a tube are components of their own, which the rings at its ends join.
TEST(CloseComponents, RingsAtTheEndsOfATube) {
  const double area = 32 * std::sin(kPi / 32) * std::cos(kPi / 32);
  TriangleMesh mesh = joined({cylinder(1, 2, 32, false), flipped(cylinder(0.5, 2, 32, false))});
  const ClosedComponents result = closed(mesh);
  ASSERT_EQ(result.holes.size(), 2u);
  EXPECT_EQ(result.holes[0].edges, 64u);
  EXPECT_NEAR(signedVolume(mesh), 1.5 * area, 1e-10);
}

TEST(CloseComponents, WithoutVolume) {
  expectOpen(sheet());
  expectOpen(joined({sheet(), sheet(3, 1)}));
  expectOpen(joined({box({0, 0, 2}, {1, 1, 3}), sheet()}));
  expectOpen(flipped(bottomless({0, 0, 0}, {1, 1, 1})));
  expectOpen(moebius());
  expectOpen(box());
  expectOpen({});
}

// A plate a little above or below the hole closes the box already. In the plane of the hole it is
// closed too, without change.
TEST(CloseComponents, HolesThatAnotherComponentCloses) {
  const TriangleMesh open = // without the side at z = 1
      without(box({0, 0, 0}, {1, 1, 1}, 2), [](std::size_t face) { return face >= 40; });
  for (const double gap : {-1e-3, 1e-3})
    expectOpen(joined({open, sheet(3, 1 + gap)}));
  TriangleMesh within = joined({open, sheet(3, 1)});
  closed(within);
  EXPECT_NEAR(signedVolume(within), 1, 1e-14);
}

// A box with a round hole in its lid and three sides missing is no solid by itself; neither is the
// hole of what stands on it a boundary of what both enclose.
TEST(CloseComponents, HolesWithinWhatSeveralBound) {
  TriangleMesh body = without(box({-1, -1, -2}, {1, 1, 0}, 8), [](std::size_t) { return false; });
  body = without(body, [&](std::size_t face) {
    Vec3d middle{0, 0, 0};
    for (std::size_t k = 0; k < 3; ++k)
      middle = plus(middle, times(body.points[body.triangles[3 * face + k]], 1.0 / 3));
    const bool hole = middle[2] == 0 && std::abs(middle[0]) < 0.5 && std::abs(middle[1]) < 0.5;
    return hole || middle[0] == -1 || middle[1] == -1 || middle[2] == -2;
  });
  const TriangleMesh tower = bottomless({-0.5, -0.5, 1e-4}, {0.5, 0.5, 1});
  const TriangleMesh lid = joined({body, tower});
  TriangleMesh mesh = lid;
  const ClosedComponents result = closed(mesh);
  EXPECT_EQ(result.faces, 0u) << result.holes.size();
}

TEST(CloseComponents, NothingDependsOnThreads) {
  TriangleMesh all;
  for (int i = 0; i < 40; ++i)
    append(all, bottomless({double(i % 7), double(i % 5), 0.1 * i},
                           {i % 7 + 1.5, i % 5 + 1.3, 0.1 * i + 0.7}));
  TriangleMesh first = all, second = all;
  const ClosedComponents result = closed(first);
  closed(second);
  EXPECT_EQ(result.holes.size(), 40u);
  EXPECT_EQ(first.triangles, second.triangles);
  EXPECT_NEAR(signedVolume(first), 40 * 1.5 * 1.3 * 0.7, 1e-10);
}

} // namespace
} // namespace tetvdb
