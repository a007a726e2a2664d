// SPDX-License-Identifier: Apache-2.0
#include "ManifoldCheck.h"
#include "TriangleMeshes.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/FillHoles.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

constexpr Vec3d kCapAxis{0.36, 0.48, 0.8};

// What was there is there still, as it was, and the mesh is closed.
HoleFilling filled(TriangleMesh& mesh, HolePatches patches = HolePatches::Smooth) {
  const TriangleMesh before = mesh;
  Progress progress;
  HoleFilling filling = fillHoles(mesh, progress, patches);
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_TRUE(std::equal(before.points.begin(), before.points.end(), mesh.points.begin()));
  EXPECT_TRUE(std::equal(before.triangles.begin(), before.triangles.end(), mesh.triangles.begin()));
  std::size_t faces = 0, points = before.points.size();
  for (const FilledHole& hole : filling.holes) {
    faces += hole.faces;
    points += hole.points;
  }
  EXPECT_EQ(mesh.points.size(), points);
  EXPECT_EQ(mesh.triangleCount(), before.triangleCount() + faces);
  return filling;
}

TEST(FillHoles, OneFace) {
  TriangleMesh mesh = without(box({0, 0, 0}, {1, 1, 1}, 3), [](std::size_t f) { return f == 11; });
  const HoleFilling filling = filled(mesh);
  ASSERT_EQ(filling.holes.size(), 1u);
  EXPECT_EQ(filling.holes[0].edges, 3u);
  EXPECT_EQ(filling.holes[0].faces, 1u);
  EXPECT_NEAR(signedVolume(mesh), 1, 1e-15);
}

TEST(FillHoles, ALidComesBack) {
  for (const int n : {1, 2, 7}) {
    // The last 2 n^2 faces are one side of the box.
    const std::size_t first = std::size_t(10 * n * n);
    TriangleMesh mesh =
        without(box({0, 0, 0}, {1, 2, 3}, n), [&](std::size_t f) { return f >= first; });
    dropUnusedPoints(mesh); // within the lid
    const HoleFilling filling = filled(mesh);
    ASSERT_EQ(filling.holes.size(), 1u);
    EXPECT_EQ(filling.holes[0].edges, std::size_t(4 * n));
    EXPECT_EQ(filling.holes[0].faces, std::size_t(4 * n - 2));
    EXPECT_NEAR(signedVolume(mesh), 6, 1e-12);
  }
}

TEST(FillHoles, CurvedHolesFollowTheSurface) {
  TriangleMesh ball = sphere({0, 0, 0}, 1, 16);
  const double whole = signedVolume(ball);
  TriangleMesh mesh = without(ball, [](std::size_t f) { return f % 256 < 9; });
  dropUnusedPoints(mesh);
  const HoleFilling filling = filled(mesh);
  EXPECT_GT(filling.holes.size(), 0u);
  EXPECT_NEAR(signedVolume(mesh), whole, 0.01 * whole);
}

TEST(FillHoles, LargeCurvedHolesAreSmooth) {
  // Of a ball everything within an angle of a direction goes: what fills the hole lies on the ball.
  const TriangleMesh ball = sphere({0, 0, 0}, 1, 24);
  for (const double cosine : {0.95, 0.85, 0.7}) {
    TriangleMesh mesh = withoutCap(ball, kCapAxis, cosine);
    dropUnusedPoints(mesh);
    const std::size_t first = mesh.points.size();
    const HoleFilling filling = filled(mesh);
    ASSERT_EQ(filling.holes.size(), 1u);
    EXPECT_GT(filling.holes[0].points, 20u);
    for (std::size_t i = first; i < mesh.points.size(); ++i)
      EXPECT_NEAR(length(mesh.points[i]), 1, 0.15 * (1 - cosine));
    const double cap = kPi * (1 - cosine) * (1 - cosine) * (2 + cosine) / 3;
    EXPECT_NEAR(signedVolume(mesh), signedVolume(ball), 0.1 * cap);
    // Faces are about as large as the others.
    double longest = 0, longestBefore = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const double size = length(minus(mesh.points[mesh.triangles[i]],
                                       mesh.points[mesh.triangles[i % 3 == 2 ? i - 2 : i + 1]]));
      double& max = i / 3 < mesh.triangleCount() - filling.holes[0].faces ? longestBefore : longest;
      max = std::max(max, size);
    }
    EXPECT_LT(longest, 2 * longestBefore);
  }
}

// The area of the faces from `first` on.
double areaFrom(const TriangleMesh& mesh, std::size_t first) {
  double area = 0;
  for (std::size_t i = 3 * first; i < mesh.triangles.size(); i += 3) {
    const Vec3d& a = mesh.points[mesh.triangles[i]];
    area += length(cross(minus(mesh.points[mesh.triangles[i + 1]], a),
                         minus(mesh.points[mesh.triangles[i + 2]], a))) /
            2;
  }
  return area;
}

TEST(FillHoles, TautPatchesSpanTheirEdges) {
  // The edges of a ball's cap, up and down about a circle of latitude.
  for (const double cosine : {0.85, 0.7, 0.2}) {
    const TriangleMesh open = withoutCap(sphere({0, 0, 0}, 1, 24), kCapAxis, cosine);
    TriangleMesh taut = open, plain = open, smooth = open;
    for (TriangleMesh* mesh : {&taut, &plain, &smooth})
      dropUnusedPoints(*mesh);
    const std::size_t firstPoint = taut.points.size(), firstFace = taut.triangleCount();
    const HoleFilling filling = filled(taut, HolePatches::Taut);
    ASSERT_EQ(filling.holes.size(), 1u);
    EXPECT_GT(filling.holes[0].points, 20u);
    EXPECT_EQ(filled(plain, HolePatches::Plain).holes[0].points, 0u);
    filled(smooth);
    for (std::size_t i = firstPoint; i < taut.points.size(); ++i)
      EXPECT_NEAR(dot(taut.points[i], kCapAxis), cosine, 0.06);
    const double disc = kPi * (1 - cosine * cosine);
    EXPECT_NEAR(areaFrom(taut, firstFace), disc, 0.1 * disc);
    EXPECT_LT(areaFrom(taut, firstFace), areaFrom(plain, firstFace));
    EXPECT_LT(areaFrom(taut, firstFace), areaFrom(smooth, firstFace));
    const double cap = kPi * (1 - cosine) * (1 - cosine) * (2 + cosine) / 3;
    EXPECT_NEAR(signedVolume(taut), 4 * kPi / 3 - cap, 0.03 * disc); // half of a face
  }
}

TEST(FillHoles, APatchThatWouldCrossIsPlain) {
  // A spike just below the ball's surface stands where the smooth patch would be.
  const TriangleMesh ball = sphere({0, 0, 0}, 1, 24);
  TriangleMesh mesh =
      joined({withoutCap(ball, kCapAxis, 0.8), box({0.33, 0.45, 0.77}, {0.38, 0.5, 1.2})});
  dropUnusedPoints(mesh);
  const std::size_t before = mesh.points.size();
  const HoleFilling filling = filled(mesh);
  ASSERT_EQ(filling.holes.size(), 1u);
  EXPECT_EQ(filling.holes[0].points, 0u);
  EXPECT_EQ(filling.holes[0].faces, filling.holes[0].edges - 2);
  EXPECT_EQ(mesh.points.size(), before);
}

TEST(FillHoles, HolesThatTouchAtAPointAreTwo) {
  const TriangleMesh ball = sphere({0, 0, 0}, 1, 6);
  // Two faces that have one point in common.
  std::size_t second = 0;
  for (std::size_t f = 1; f < ball.triangleCount() && second == 0; ++f) {
    std::size_t common = 0;
    for (std::size_t i = 0; i < 9; ++i)
      common += ball.triangles[i / 3] == ball.triangles[3 * f + i % 3];
    if (common == 1)
      second = f;
  }
  TriangleMesh mesh = without(ball, [&](std::size_t f) { return f == 0 || f == second; });
  const HoleFilling filling = filled(mesh);
  EXPECT_EQ(filling.holes.size(), 2u);
  EXPECT_EQ(mesh.triangleCount(), ball.triangleCount());
  EXPECT_NEAR(signedVolume(mesh), signedVolume(ball), 1e-12);
}

TEST(FillHoles, ARingStaysOpenWithin) {
  // A cup's wall without its upper edge: two shells whose loops lie in one plane.
  TriangleMesh cup =
      joined({without(box({0, 0, 0}, {4, 4, 4}), [](std::size_t f) { return f >= 10; }),
              flipped(without(box({1, 1, 1}, {3, 3, 4}), [](std::size_t f) { return f >= 10; }))});
  const HoleFilling filling = filled(cup);
  ASSERT_EQ(filling.holes.size(), 1u);
  EXPECT_EQ(filling.holes[0].edges, 8u);
  EXPECT_NEAR(signedVolume(cup), 64 - 12, 1e-12);
}

TEST(FillHoles, LongLoopsAreCutIntoShort) {
  TriangleMesh tube = moved(cylinder(1, 3, 700, false), [](const Vec3d& p) {
    return Vec3d{p[0], p[1], p[2] + (p[2] > 0 ? 0.2 * p[0] * p[1] : 0.1 * p[0] * p[0])};
  });
  const HoleFilling filling = filled(tube);
  ASSERT_EQ(filling.holes.size(), 2u);
  EXPECT_EQ(filling.holes[0].faces, 698u);
  // Of heights over the disc: 3 + 0 - 0.1 / 4 of its area, whatever spans the saddle between
  // the least and the largest height.
  EXPECT_NEAR(signedVolume(tube), kPi * (3 - 0.025), 0.35);
}

TEST(FillHoles, NothingToDo) {
  TriangleMesh mesh = torus();
  EXPECT_TRUE(filled(mesh).holes.empty());
}

} // namespace
} // namespace tetvdb
