// SPDX-License-Identifier: Apache-2.0
#include "ManifoldCheck.h"
#include "TriangleMeshes.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/surface/FloatPositions.h"
#include "tetvdb/surface/LocalRepair.h"
#include "tetvdb/surface/MeshChanges.h"
#include "tetvdb/surface/RemoveCrossings.h"
#include "tetvdb/surface/SelfIntersections.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <utility>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

// Sides of every edge cancel, and nothing crosses.
void expectInOrder(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> excess;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t a = mesh.triangles[i], b = mesh.triangles[i % 3 == 2 ? i - 2 : i + 1];
    ++excess[{a, b}];
    --excess[{b, a}];
  }
  for (const auto& [edge, sum] : excess)
    ASSERT_EQ(sum, 0);
  Progress progress;
  EXPECT_EQ(countIntersections(mesh.points, mesh.triangles, 1000, progress).pairs, 0u);
}

CrossingCounts removed(TriangleMesh& mesh) {
  Progress progress;
  const CrossingCounts counts = removeCrossings(mesh, NewCorners::FloatsAsGiven, progress);
  EXPECT_TRUE(counts.complete);
  expectInOrder(mesh);
  return counts;
}

TEST(RemoveCrossings, NothingToDo) {
  for (const TriangleMesh& given : {torus(), box({0, 0, 0}, {1, 1, 1}, 3), sphere()}) {
    TriangleMesh mesh = given;
    const CrossingCounts counts = removed(mesh);
    EXPECT_EQ(counts.metFaces + counts.cutFaces + counts.removedFaces, 0u);
    EXPECT_EQ(mesh.triangles, given.triangles);
    EXPECT_EQ(mesh.points, given.points);
  }
}

TEST(RemoveCrossings, TwoBoxesBecomeTheirUnion) {
  TriangleMesh mesh =
      joined({box({0, 0, 0}, {1, 1, 1}, 4), box({0.53, 0.21, 0.33}, {1.7, 0.9, 0.8}, 3)});
  const TriangleMesh before = mesh;
  const CrossingCounts counts = removed(mesh);
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_EQ(eulerCharacteristic(mesh), 2);
  EXPECT_NEAR(signedVolume(mesh), 1 + 0.7 * 0.69 * 0.47, 1e-12);
  EXPECT_GT(counts.cutFaces, 0u);
  EXPECT_GT(counts.removedFaces, 0u);
  // Faces that nothing crosses stay, in order, in front.
  const MeshChanges changes = meshChanges(before, mesh);
  EXPECT_EQ(changes.kept, before.triangleCount() - counts.cutFaces - counts.removedFaces);
  EXPECT_EQ(changes.added, counts.addedFaces);
}

// Two prisms whose edges, one along z and one along y, cross at the origin.
TEST(RemoveCrossings, EdgesThatCrossAtAPointAreDividedThere) {
  const auto prism = [](const Vec3d& along, const Vec3d& out, const Vec3d& aside) {
    TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1});
    for (Vec3d& p : mesh.points) { // a square whose corner lies on the edge, twice as long as wide
      const double a = p[0], b = p[1], c = 4 * p[2] - 1.5;
      p = plus(times(along, c), plus(times(out, a + b), times(aside, a - b)));
    }
    return mesh;
  };
  const TriangleMesh left = prism({0, 0, 1}, {-1, 0, 0}, {0, 1, 0});
  const TriangleMesh right = prism({0, 1, 0}, {1, 0, 0}, {0, 0, 1});
  for (const TriangleMesh& one : {left, flipped(left)})
    for (const TriangleMesh& other : {right, flipped(right)}) {
      if (signedVolume(one) < 0 || signedVolume(other) < 0)
        continue;
      TriangleMesh mesh = joined({one, other});
      Progress progress;
      ASSERT_EQ(countIntersections(mesh.points, mesh.triangles, 1000, progress).pairs, 4u);
      const CrossingCounts counts = removed(mesh);
      EXPECT_EQ(counts.cutFaces, 4u);
      EXPECT_EQ(counts.addedFaces, 8u);
      EXPECT_EQ(counts.removedFaces, 0u);
      EXPECT_NEAR(signedVolume(mesh), signedVolume(one) + signedVolume(other), 1e-12);
    }
}

TEST(RemoveCrossings, BallsAtAnyAngle) {
  // The volume of two balls' union is known but for their facets; of the lens between the facets'
  // balls the sum tells: volume of A + volume of B - volume of the union.
  const TriangleMesh a = sphere({0.013, 0.027, 0.031}, 1, 12),
                     b = sphere({0.7, 0.31, 0.23}, 0.8, 10);
  TriangleMesh mesh = joined({a, b});
  removed(mesh);
  EXPECT_EQ(manifoldDefect(mesh), "");
  const double d = std::sqrt(0.687 * 0.687 + 0.283 * 0.283 + 0.199 * 0.199);
  const double r = 1, s = 0.8;
  const double lens = kPi * (r + s - d) * (r + s - d) *
                      (d * d + 2 * d * s - 3 * s * s + 2 * d * r + 6 * r * s - 3 * r * r) /
                      (12 * d);
  EXPECT_NEAR(signedVolume(mesh), signedVolume(a) + signedVolume(b) - lens, 0.03);
}

TEST(RemoveCrossings, FacesInOnePlane) {
  // Side by side with a face in part common, one on another with sides in one plane, and twice the
  // same, moved within its planes.
  for (const auto& [given, volume] : std::initializer_list<std::pair<TriangleMesh, double>>{
           {joined({box({0, 0, 0}, {1, 1, 1}, 2), box({1, 0.25, 0.25}, {2, 0.75, 0.75}, 2)}), 1.25},
           {joined({box({0, 0, 0}, {1, 1, 1}), box({0, 0, 1}, {1, 1, 2}, 3)}), 2},
           {joined({box({0, 0, 0}, {2, 1, 1}), box({0.5, 0, 0}, {3, 1, 1})}), 3}}) {
    TriangleMesh mesh = given;
    removed(mesh);
    EXPECT_NEAR(signedVolume(mesh), volume, 1e-12);
  }
}

TEST(RemoveCrossings, WhatIsWithinGoesAndCavitiesStay) {
  const TriangleMesh outer = box({0, 0, 0}, {4, 4, 4}, 3),
                     cavity = flipped(box({1, 1, 1}, {3, 3, 3}));
  TriangleMesh hollow = joined({outer, cavity});
  EXPECT_EQ(removed(hollow).removedFaces, 0u);
  EXPECT_NEAR(signedVolume(hollow), 64 - 8, 1e-12);
  TriangleMesh filled = joined({outer, box({1, 1, 1}, {3, 3, 3})});
  EXPECT_EQ(removed(filled).removedFaces, 12u);
  EXPECT_EQ(filled.triangles, outer.triangles);
  TriangleMesh insideOut = joined({outer, flipped(box({5, 5, 5}, {6, 6, 6}))});
  EXPECT_EQ(removed(insideOut).removedFaces, 12u);
}

TEST(RemoveCrossings, ManyBoxesInFloats) {
  // New corners are floats where all points are.
  Random random(11);
  TriangleMesh mesh;
  for (int i = 0; i < 12; ++i) {
    Vec3d low, high;
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = random.unit();
      high[k] = low[k] + 0.2 + 0.5 * random.unit();
    }
    append(mesh, box(low, high));
  }
  // Turned, so that no faces lie in one plane or along an axis.
  mesh = moved(mesh, [](const Vec3d& p) {
    const Vec3d q{0.36 * p[0] + 0.48 * p[1] - 0.8 * p[2], -0.8 * p[0] + 0.6 * p[1],
                  0.48 * p[0] + 0.64 * p[1] + 0.6 * p[2]};
    return nearestFloats(q);
  });
  const TriangleMesh before = mesh;
  removed(mesh);
  for (const Vec3d& p : mesh.points)
    ASSERT_EQ(nearestFloats(p), p);
  Progress progress;
  const SolidComparison solids = compareSolids(before, mesh, progress);
  EXPECT_EQ(solids.lost + solids.gained, 0);
  EXPECT_NEAR(solids.before, signedVolume(mesh), 0.03 * solids.before);
}

TEST(RemoveCrossings, TheSameForAnyOrderOfFaces) {
  const TriangleMesh mesh =
      joined({sphere({0, 0, 0}, 1, 6), torus(), box({0, 0, 0}, {1, 1, 1}, 2)});
  TriangleMesh first = mesh, second = shuffledFaces(mesh);
  removed(first);
  removed(second);
  EXPECT_EQ(meshChanges(first, second).removed, 0u);
  EXPECT_EQ(meshChanges(first, second).added, 0u);
}

TEST(RemoveCrossings, CornersThatTouchFacesBecomeCorners) {
  // The tip of a pyramid on the side of a box, in the middle of a face and on an edge within it.
  for (const Vec3d& tip : {Vec3d{1, 0.25, 0.5}, Vec3d{1, 0.5, 0.5}}) {
    TriangleMesh pyramid;
    pyramid.points = {tip, {2, 0, 0}, {2, 1, 0}, {2, 1, 1}, {2, 0, 1}};
    pyramid.triangles = {0, 2, 1, 0, 3, 2, 0, 4, 3, 0, 1, 4, 1, 2, 3, 1, 3, 4};
    pyramid.faceCount = 6;
    const TriangleMesh given = joined({box({0, 0, 0}, {1, 1, 1}), pyramid});
    TriangleMesh mesh = given;
    removed(mesh);
    EXPECT_NEAR(signedVolume(mesh), 1 + 1.0 / 3, 1e-14);
    EXPECT_EQ(mesh.points.size(), given.points.size());
    mesh = given;
    Progress progress;
    const LocalRepair repair = repairLocally(mesh, progress);
    ASSERT_TRUE(repair.succeeded) << repair.why;
    EXPECT_EQ(manifoldDefect(mesh), "");
    EXPECT_NEAR(signedVolume(mesh), 1 + 1.0 / 3, 1e-5);
    EXPECT_EQ(repair.separatedPoints, 1u);
  }
}

TEST(RemoveCrossings, EdgesThatTouchFacesDivideThem) {
  // A wedge's edge on the side of a box: within a face, and across it and beyond.
  for (const auto& [low, high] : {std::pair{0.125, 0.25}, std::pair{-0.5, 1.5}}) {
    TriangleMesh wedge;
    wedge.points = {{1, low, 0.625},  {2, low, 0.25},  {2, low, 1},
                    {1, high, 0.625}, {2, high, 0.25}, {2, high, 1}};
    wedge.triangles = {0, 1, 2, 3, 5, 4, 0, 3, 1, 3, 4, 1, 1, 4, 2, 4, 5, 2, 2, 5, 0, 5, 3, 0};
    wedge.faceCount = 8;
    const double volume = 1 + 0.375 * (high - low);
    const TriangleMesh given = joined({box({0, 0, 0}, {1, 1, 1}), wedge});
    ASSERT_NEAR(signedVolume(given), volume, 1e-14);
    TriangleMesh mesh = given;
    removed(mesh);
    EXPECT_NEAR(signedVolume(mesh), volume, 1e-14);
    mesh = given;
    Progress progress;
    const LocalRepair repair = repairLocally(mesh, progress);
    ASSERT_TRUE(repair.succeeded) << repair.why;
    EXPECT_EQ(manifoldDefect(mesh), "");
    EXPECT_NEAR(signedVolume(mesh), volume, 1e-5);
    EXPECT_GE(repair.separatedPoints, 2u);
  }
}

TEST(RemoveCrossings, AsAStepOfRepair) {
  // A face folded into its neighbours: the crossing is mended around it alone.
  TriangleMesh mesh = moved(sphere({0, 0, 0}, 1, 16), [](const Vec3d& p) {
    return p[2] > 0.999 ? Vec3d{0.05, 0.04, 0.55} : p;
  });
  mesh = moved(mesh, [](const Vec3d& p) { return nearestFloats(p); });
  append(mesh, box({0.9, -0.1, -0.1}, {1.3, 0.1, 0.1}));
  const TriangleMesh before = mesh;
  Progress progress;
  const LocalRepair repair = repairLocally(mesh, progress);
  ASSERT_TRUE(repair.succeeded) << repair.why;
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_EQ(whatIsBroken(mesh, progress), "");
  EXPECT_GT(meshChanges(before, mesh).kept, before.triangleCount() * 98 / 100);
}

} // namespace
} // namespace tetvdb
