// SPDX-License-Identifier: Apache-2.0
#include "ManifoldCheck.h"
#include "TriangleMeshes.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/surface/FloatPositions.h"
#include "tetvdb/surface/LocalRepair.h"
#include "tetvdb/surface/RoundToFloats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

constexpr double kUnit = 0x1p-14; // floats from 512 to 1024 are its multiples
using Whole = std::array<std::int64_t, 3>;

Whole inUnits(const Vec3d& p) {
  return {std::llround(p[0] / kUnit), std::llround(p[1] / kUnit), std::llround(p[2] / kUnit)};
}

// Of the tet a, b, c, d: exact within 2^19 units.
int signOfVolume(const Whole& a, const Whole& b, const Whole& c, const Whole& d) {
  std::array<Whole, 3> m;
  for (std::size_t k = 0; k < 3; ++k)
    m[0][k] = b[k] - a[k], m[1][k] = c[k] - a[k], m[2][k] = d[k] - a[k];
  const std::int64_t volume = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                              m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                              m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return (volume > 0) - (volume < 0);
}

// Pairs of an edge and a face without common points that pierce one another, all with all.
int piercings(const TriangleMesh& mesh) {
  std::vector<Whole> points;
  for (const Vec3d& p : mesh.points)
    points.push_back(inUnits(p));
  int count = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const std::uint32_t* f = &mesh.triangles[i];
    for (std::size_t j = 0; j < mesh.triangles.size(); ++j) {
      const std::uint32_t p = mesh.triangles[j], q = mesh.triangles[j - j % 3 + (j + 1) % 3];
      if (p > q || std::count(f, f + 3, p) + std::count(f, f + 3, q) > 0)
        continue;
      const Whole &a = points[f[0]], &b = points[f[1]], &c = points[f[2]];
      bool isApart = false;
      for (std::size_t k = 0; k < 3; ++k)
        isApart = isApart || std::max(points[p][k], points[q][k]) < std::min({a[k], b[k], c[k]}) ||
                  std::min(points[p][k], points[q][k]) > std::max({a[k], b[k], c[k]});
      if (isApart)
        continue;
      if (signOfVolume(a, b, c, points[p]) * signOfVolume(a, b, c, points[q]) != -1)
        continue;
      const int ab = signOfVolume(a, b, points[p], points[q]),
                bc = signOfVolume(b, c, points[p], points[q]),
                ca = signOfVolume(c, a, points[p], points[q]);
      count += ab == bc && bc == ca && ab != 0;
    }
  }
  return count;
}

// Balls through one another, cut along their intersections, where floats are coarse.
TriangleMesh cutBalls(std::uint64_t seed) {
  Random random(seed);
  TriangleMesh mesh;
  for (int i = 0; i < 6; ++i) {
    const Vec3d centre{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    mesh = joined({mesh, sphere(centre, random.between(0.6, 1.2), 10)});
  }
  Progress progress;
  cleanTriangles(mesh, {}, progress);
  const LocalRepair repair = repairLocally(mesh, progress);
  EXPECT_TRUE(repair.succeeded) << repair.why;
  return moved(mesh, [](const Vec3d& p) { return plus(times(p, 0.02), {600, 700, 800}); });
}

TriangleMesh nearest(TriangleMesh mesh) {
  for (Vec3d& p : mesh.points)
    p = nearestFloats(p);
  return mesh;
}

TEST(RoundToFloats, FacesThatCrossByRoundingAreMended) {
  int pierced = 0;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    const TriangleMesh cut = cutBalls(seed);
    ASSERT_FALSE(areFloats(cut.points));
    const int before = piercings(nearest(cut));
    pierced += before;
    TriangleMesh mesh = cut;
    Progress progress;
    const FloatRounding rounding = roundToFloats(mesh, progress);
    EXPECT_TRUE(rounding.complete);
    EXPECT_EQ(rounding.crossings, 0u);
    EXPECT_GE(rounding.crossingFaces, before > 0 ? 2u : 0u);
    EXPECT_TRUE(areFloats(mesh.points));
    EXPECT_EQ(manifoldDefect(mesh), "");
    EXPECT_EQ(whatIsBroken(mesh, progress), "");
    EXPECT_EQ(piercings(mesh), 0);
    EXPECT_LT(rounding.largestMove, 300 * kUnit);
    EXPECT_NEAR(signedVolume(mesh), signedVolume(cut), 0.01 * signedVolume(cut));
    const std::size_t faces = mesh.triangleCount() + 2 * rounding.contractedEdges;
    EXPECT_EQ(faces, cut.triangleCount());
  }
  EXPECT_GT(pierced, 10);
}

// A box whose lid has a point beside the middle of its diagonal.
TEST(RoundToFloats, FacesWithoutAreaByRoundingAreFlippedAway) {
  TriangleMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0},
                 {0, 1, 0}, {0, 0, 1}, {1, 0, 1},
                 {1, 1, 1}, {0, 1, 1}, {0.5, 0.5 - 0x1p-40, 1}};
  for (const std::array<std::uint32_t, 3>& f : std::vector<std::array<std::uint32_t, 3>>{{0, 2, 1},
                                                                                         {0, 3, 2},
                                                                                         {0, 1, 5},
                                                                                         {0, 5, 4},
                                                                                         {1, 2, 6},
                                                                                         {1, 6, 5},
                                                                                         {2, 3, 7},
                                                                                         {2, 7, 6},
                                                                                         {3, 0, 4},
                                                                                         {3, 4, 7},
                                                                                         {4, 6, 7},
                                                                                         {4, 5, 8},
                                                                                         {5, 6, 8},
                                                                                         {6, 4, 8}})
    addTriangle(mesh, f[0], f[1], f[2]);
  Progress progress;
  ASSERT_EQ(whatIsBroken(mesh, progress), "");
  ASSERT_EQ(whatIsBroken(nearest(mesh), progress), "1 face without area");
  const FloatRounding rounding = roundToFloats(mesh, progress);
  EXPECT_EQ(rounding.roundedPoints, 1u);
  EXPECT_EQ(rounding.flippedEdges, 1u);
  EXPECT_EQ(rounding.movedPoints + rounding.contractedEdges, 0u);
  EXPECT_EQ(whatIsBroken(mesh, progress), "");
  EXPECT_EQ(mesh.triangleCount(), 14u);
  EXPECT_NEAR(signedVolume(mesh), 1, 1e-15);
}

TEST(RoundToFloats, FloatsStay) {
  TriangleMesh mesh = nearest(torus());
  const TriangleMesh before = mesh;
  Progress progress;
  const FloatRounding rounding = roundToFloats(mesh, progress);
  EXPECT_EQ(rounding.roundedPoints, 0u);
  EXPECT_EQ(mesh.points, before.points);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

TEST(RoundToFloats, WhatIsNoClosedManifoldIsOnlyRounded) {
  TriangleMesh mesh = without(torus(), [](std::size_t face) { return face == 7; });
  const std::vector<std::uint32_t> before = mesh.triangles;
  Progress progress;
  const FloatRounding rounding = roundToFloats(mesh, progress);
  EXPECT_FALSE(rounding.complete);
  EXPECT_TRUE(areFloats(mesh.points));
  EXPECT_EQ(mesh.triangles, before);
}

} // namespace
} // namespace tetvdb
