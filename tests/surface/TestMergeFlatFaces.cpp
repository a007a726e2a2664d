// SPDX-License-Identifier: Apache-2.0
#include "DistanceBetween.h"
#include "ManifoldCheck.h"
#include "TriangleMeshes.h"
#include "tetvdb/surface/MergeFlatFaces.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <set>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

TriangleMesh merged(TriangleMesh mesh, double tolerance, bool outward = false) {
  Progress progress;
  const TriangleMesh before = mesh;
  const double moved = mergeFlatFaces(mesh, tolerance, outward, progress);
  EXPECT_EQ(manifoldDefect(mesh, false), "");
  EXPECT_LE(moved, tolerance);
  EXPECT_LE(distanceBetween(before, mesh), moved + 1e-12);
  return mesh;
}

Vec3d turned(const Vec3d& p) {
  return {0.36 * p[0] + 0.48 * p[1] - 0.8 * p[2] + 7, -0.8 * p[0] + 0.6 * p[1],
          0.48 * p[0] + 0.64 * p[1] + 0.6 * p[2] - 3};
}

// Sides and edges of a box at any angle, over several cubes of space.
TEST(MergeFlatFaces, ABoxKeepsItsSidesEdgesAndCorners) {
  const TriangleMesh mesh = moved(box({0, 0, 0}, {3, 2, 1}, 100), turned);
  const TriangleMesh made = merged(mesh, 1e-9);
  EXPECT_LT(made.triangleCount(), mesh.triangleCount() / 50);
  EXPECT_NEAR(signedVolume(made), 6, 1e-9);
  const std::set<Vec3d> before(mesh.points.begin(), mesh.points.end());
  for (const Vec3d& p : made.points)
    EXPECT_EQ(before.count(p), 1u);
}

TEST(MergeFlatFaces, CurvedSurfacesStayWithinTheTolerance) {
  const auto wavy = [](const Vec3d& p) {
    return Vec3d{p[0], p[1], p[2] + 0.02 * std::sin(5 * p[0]) * std::cos(4 * p[1])};
  };
  for (const TriangleMesh& mesh : {sphere({3, -2, 9}, 2, 60), torus(1, 0.3, 180, 100),
                                   moved(box({0, 0, 0}, {2, 2, 1}, 60), wavy)}) {
    std::size_t last = mesh.triangleCount();
    for (const double tolerance : {0.001, 0.004, 0.02}) {
      const TriangleMesh made = merged(mesh, tolerance);
      EXPECT_LT(made.triangleCount(), last);
      EXPECT_EQ(eulerCharacteristic(made), eulerCharacteristic(mesh));
      last = made.triangleCount();
    }
    EXPECT_LT(last, mesh.triangleCount() / 2);
  }
}

// Judged by winding numbers at random points near the surface. Planes at an angle are flat but for
// rounding, to both sides.
TEST(MergeFlatFaces, OutwardTakesNothingFromTheSolid) {
  const auto wavy = [](const Vec3d& p) {
    return turned({p[0], p[1], p[2] + 0.02 * std::sin(5 * p[0]) * std::cos(4 * p[1])});
  };
  const double tolerance = 0.01;
  for (const auto& mesh : {moved(box({0, 0, 0}, {2, 2, 1}, 24), wavy), torus(1, 0.3, 100, 50),
                           flipped(torus(1, 0.3, 100, 50))}) {
    const TriangleMesh made = merged(mesh, tolerance, true);
    EXPECT_LT(made.triangleCount(), mesh.triangleCount() * 9 / 10);
    EXPECT_GT(signedVolume(made), signedVolume(mesh));
    const double solid = signedVolume(mesh) > 0 ? 0.5 : -0.5;
    Random random(7);
    int kept = 0, grown = 0;
    for (int i = 0; i < 3000; ++i) {
      Vec3d p = mesh.points[random.below(mesh.points.size())];
      for (double& x : p)
        x += random.between(-tolerance / 8, tolerance / 8);
      const bool was = windingNumberAt(mesh, p) > solid, is = windingNumberAt(made, p) > solid;
      EXPECT_TRUE(is || !was);
      kept += was;
      grown += is && !was;
    }
    EXPECT_GT(kept, 500);
    EXPECT_GT(grown, 20);
  }
  const TriangleMesh turnedBox = moved(box({0, 0, 0}, {3, 2, 1}, 60), turned);
  EXPECT_LT(merged(turnedBox, 1e-9, true).triangleCount(), turnedBox.triangleCount() / 20);
}

// Two walls nearer to each other than the tolerance.
TEST(MergeFlatFaces, NoCrossingsComeIn) {
  for (const double gap : {0.002, 0.0005}) {
    const TriangleMesh mesh =
        joined({sphere({0, 0, 0}, 1, 48), flipped(sphere({0, 0, 0}, 1 - gap, 62))});
    ASSERT_EQ(crossingsOf(mesh), 0u);
    for (const double tolerance : {0.01, 0.05})
      EXPECT_EQ(crossingsOf(merged(mesh, tolerance)), 0u);
  }
}

TEST(MergeFlatFaces, RegionsWithoutCrossingsAreMergedAllTheSame) {
  const TriangleMesh mesh = joined({sphere({0, 0, 0}, 1, 48), flipped(sphere({0, 0, 0}, 0.998, 62)),
                                    box({2, 0, 0}, {5, 3, 3}, 60)});
  const TriangleMesh made = merged(mesh, 0.01);
  EXPECT_EQ(crossingsOf(made), 0u);
  EXPECT_LT(made.triangleCount(), mesh.triangleCount() - 30000);
}

TEST(MergeFlatFaces, TheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = torus(1, 0.4, 400, 200);
  TriangleMesh one, four;
  tbb::task_arena(1).execute([&] { one = merged(mesh, 0.001); });
  tbb::task_arena(4).execute([&] { four = merged(mesh, 0.001); });
  EXPECT_EQ(one.points, four.points);
  EXPECT_EQ(one.triangles, four.triangles);
  EXPECT_LT(one.triangleCount(), mesh.triangleCount() * 3 / 4);
}

TEST(MergeFlatFaces, WhatIsNoClosedManifoldStaysAsItIs) {
  TriangleMesh boxes = box({0, 0, 0}, {1, 1, 1}, 8), other = box({1, 1, 1}, {2, 2, 2}, 8);
  // They have one corner in common.
  const auto first = static_cast<std::uint32_t>(boxes.points.size());
  const auto indexOf = [](const TriangleMesh& mesh, const Vec3d& p) {
    return static_cast<std::uint32_t>(std::find(mesh.points.begin(), mesh.points.end(), p) -
                                      mesh.points.begin());
  };
  const std::uint32_t here = indexOf(boxes, {1, 1, 1}), there = first + indexOf(other, {1, 1, 1});
  append(boxes, other);
  for (std::uint32_t& v : boxes.triangles)
    v = v == there ? here : v;
  for (TriangleMesh mesh : {boxes, sheet(9), withFacesFlipped(sphere(), 0.1), TriangleMesh()}) {
    const std::vector<std::uint32_t> before = mesh.triangles;
    Progress progress;
    EXPECT_EQ(mergeFlatFaces(mesh, 0.1, false, progress), 0);
    EXPECT_EQ(mesh.triangles, before);
  }
}

} // namespace
} // namespace tetvdb
