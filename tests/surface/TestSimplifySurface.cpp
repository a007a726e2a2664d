// SPDX-License-Identifier: Apache-2.0
#include "DistanceBetween.h"
#include "ManifoldCheck.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/surface/SelfIntersections.h"
#include "tetvdb/surface/SimplifySurface.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <set>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

TriangleMesh simplified(TriangleMesh mesh, const SimplifyOptions& options) {
  Progress progress;
  simplifySurface(mesh, options, progress);
  EXPECT_EQ(manifoldDefect(mesh, false), "");
  return mesh;
}

SimplifyOptions within(double tolerance) {
  SimplifyOptions options;
  options.tolerance = tolerance;
  return options;
}

SimplifyOptions toFaces(std::size_t faces) {
  SimplifyOptions options;
  options.faces = faces;
  options.featureDegrees = 40;
  return options;
}

TEST(SimplifySurface, StaysWithinTheTolerance) {
  for (const TriangleMesh& mesh : {sphere({3, -2, 9}, 2, 30), torus(1, 0.3, 90, 50)}) {
    std::size_t last = mesh.triangleCount();
    for (const double tolerance : {0.002, 0.01, 0.05}) {
      const TriangleMesh made = simplified(mesh, within(tolerance));
      EXPECT_LT(made.triangleCount(), last);
      EXPECT_LT(distanceBetween(mesh, made), tolerance);
      EXPECT_EQ(eulerCharacteristic(made), eulerCharacteristic(mesh));
      last = made.triangleCount();
    }
    EXPECT_LT(last, mesh.triangleCount() / 10);
    const std::set<Vec3d> before(mesh.points.begin(), mesh.points.end());
    for (const Vec3d& p : simplified(mesh, within(0.05)).points)
      EXPECT_EQ(before.count(p), 1u);
  }
}

TEST(SimplifySurface, AFlatBoxBecomesTwelveFaces) {
  const TriangleMesh mesh = box({0, 0, 0}, {3, 2, 1}, 24);
  for (const double degrees : {180.0, 40.0}) {
    SimplifyOptions options = within(1e-4);
    options.featureDegrees = degrees;
    const TriangleMesh made = simplified(mesh, options);
    EXPECT_EQ(made.triangleCount(), 12u);
    EXPECT_DOUBLE_EQ(signedVolume(made), 6);
  }
}

// A tolerance that would let the circles be cut off.
TEST(SimplifySurface, FeatureEdgesAreKept) {
  TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1}, 40);
  for (Vec3d& p : mesh.points) // dents that are no features, within the tolerance
    p[2] += 0.002 * std::sin(7 * p[0]) * std::sin(9 * p[1]);
  SimplifyOptions options = within(0.06);
  options.featureDegrees = 40;
  const TriangleMesh made = simplified(mesh, options);
  const auto onEdges = [](const TriangleMesh& of) { // length of what lies on the upright edges
    double sum = 0;
    for (std::size_t i = 0; i < of.triangles.size(); ++i) {
      const Vec3d& a = of.points[of.triangles[i]];
      const Vec3d& b = of.points[of.triangles[i % 3 == 2 ? i - 2 : i + 1]];
      bool on = true;
      for (std::size_t axis = 0; axis < 2; ++axis)
        on = on && a[axis] == b[axis] && (a[axis] == 0 || a[axis] == 1);
      sum += on ? std::abs(a[2] - b[2]) / 2 : 0;
    }
    return sum;
  };
  EXPECT_NEAR(onEdges(mesh), 4, 1e-9);
  EXPECT_NEAR(onEdges(made), onEdges(mesh), 1e-9);
  EXPECT_LT(made.triangleCount(), 200u);
}

TEST(SimplifySurface, EndsAtANumberOfFaces) {
  const TriangleMesh ball = sphere({0, 0, 0}, 1, 20); // 3200
  double last = 0;
  for (const std::size_t faces : {2001u, 500u, 100u, 20u}) {
    const TriangleMesh made = simplified(ball, toFaces(faces));
    EXPECT_LE(made.triangleCount(), faces);
    EXPECT_GT(made.triangleCount() + 2, faces - faces % 2);
    EXPECT_EQ(crossingsOf(made), 0u);
    const double distance = distanceBetween(ball, made);
    EXPECT_GT(distance, last);
    last = distance;
  }
  EXPECT_EQ(simplified(ball, toFaces(5000)).triangles, ball.triangles);
  // Features go where there is no other way: the box has twelve faces with them.
  EXPECT_LE(simplified(box({0, 0, 0}, {1, 1, 1}, 10), toFaces(8)).triangleCount(), 8u);
}

TEST(SimplifySurface, BothLimitsHold) {
  SimplifyOptions options = toFaces(100);
  options.tolerance = 0.01;
  const TriangleMesh ball = sphere({0, 0, 0}, 1, 20);
  const TriangleMesh made = simplified(ball, options);
  EXPECT_GT(made.triangleCount(), 100u);
  EXPECT_LT(distanceBetween(ball, made), 0.01);
}

// Two walls nearer to each other than the tolerance.
// Judged by winding numbers at random points near the surface, and by distances of points of both:
// what was solid stays solid, also where the surface is dented or has saddles.
TEST(SimplifySurface, OutwardTakesNothingFromTheSolid) {
  const auto bumpy = [](const Vec3d& p) {
    const double r = 1 + 0.1 * std::sin(5 * p[0]) * std::cos(4 * p[1] + p[2]);
    return Vec3d{r * p[0], r * p[1], r * p[2]};
  };
  const double tolerance = 0.02;
  SimplifyOptions options = within(tolerance);
  options.outward = true;
  for (const bool inward : {false, true})
    for (TriangleMesh mesh : {moved(sphere({0, 0, 0}, 1, 24), bumpy), torus(1, 0.3, 60, 30)}) {
      if (inward)
        mesh = flipped(mesh); // a cavity: its solid is around it
      const TriangleMesh made = simplified(mesh, options);
      EXPECT_LT(made.triangleCount(), mesh.triangleCount() * 3 / 4);
      EXPECT_EQ(crossingsOf(made), 0u);
      EXPECT_LT(distanceBetween(mesh, made), tolerance);
      EXPECT_GT(signedVolume(made), signedVolume(mesh));
      Random random(3);
      int kept = 0, grown = 0;
      for (int i = 0; i < 600; ++i) {
        Vec3d p = mesh.points[random.below(mesh.points.size())];
        for (double& x : p)
          x += random.between(-tolerance, tolerance);
        const bool was = windingNumberAt(mesh, p) > (inward ? -0.5 : 0.5);
        const bool is = windingNumberAt(made, p) > (inward ? -0.5 : 0.5);
        EXPECT_TRUE(is || !was);
        kept += was;
        grown += is && !was;
      }
      EXPECT_GT(kept, 100);
      EXPECT_GT(grown, 10);
    }
}

TEST(SimplifySurface, NoCrossingsComeIn) {
  for (const double gap : {0.02, 0.004}) {
    TriangleMesh mesh = joined({sphere({0, 0, 0}, 1, 24), flipped(sphere({0, 0, 0}, 1 - gap, 31))});
    ASSERT_EQ(crossingsOf(mesh), 0u);
    for (const double tolerance : {0.01, 0.1})
      EXPECT_EQ(crossingsOf(simplified(mesh, within(tolerance))), 0u);
    EXPECT_EQ(crossingsOf(simplified(mesh, toFaces(300))), 0u);
  }
  // Cut into cubes of space, in which crossings are looked for afterwards.
  const TriangleMesh mesh =
      joined({sphere({0, 0, 0}, 1, 37), flipped(sphere({0, 0, 0}, 0.998, 42))});
  ASSERT_EQ(crossingsOf(mesh), 0u);
  EXPECT_EQ(crossingsOf(simplified(mesh, within(0.02))), 0u);
}

TEST(SimplifySurface, TheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = torus(1, 0.4, 240, 120); // cut into cubes of space
  SimplifyOptions options = within(0.002);
  options.featureDegrees = 40;
  TriangleMesh one, two;
  tbb::task_arena(1).execute([&] { one = simplified(mesh, options); });
  tbb::task_arena(4).execute([&] { two = simplified(mesh, options); });
  EXPECT_EQ(one.points, two.points);
  EXPECT_EQ(one.triangles, two.triangles);
  EXPECT_LT(one.triangleCount(), mesh.triangleCount() / 4);
  EXPECT_LT(distanceBetween(mesh, one), 0.002);
}

TEST(SimplifySurface, RefusesWhatIsNoClosedManifold) {
  const auto statusOf = [](TriangleMesh mesh, const SimplifyOptions& options) {
    Progress progress;
    try {
      simplifySurface(mesh, options, progress);
    } catch (const Error& error) {
      return error.status();
    }
    return Status::Ok;
  };
  EXPECT_EQ(statusOf(sheet(4), within(1)), Status::Invalid);
  EXPECT_EQ(statusOf(withFacesFlipped(sphere(), 0.1), within(1)), Status::Invalid);
  TriangleMesh repeated = sphere();
  addTriangle(repeated, 0, 0, 1);
  EXPECT_EQ(statusOf(repeated, within(1)), Status::Invalid);
  TriangleMesh tips = sphere({0, 0, 0}, 1, 6), other = sphere({2, 0, 0}, 1, 6);
  // Two balls that have one vertex in common.
  const auto first = static_cast<std::uint32_t>(tips.points.size());
  std::uint32_t right = 0, left = 0;
  for (std::uint32_t v = 0; v < first; ++v) {
    right = tips.points[v][0] > tips.points[right][0] ? v : right;
    left = other.points[v][0] < other.points[left][0] ? v : left;
  }
  append(tips, other);
  for (std::uint32_t& v : tips.triangles)
    v = v == first + left ? right : v;
  EXPECT_EQ(statusOf(tips, within(0.01)), Status::Invalid);
  EXPECT_EQ(statusOf(sphere(), {}), Status::Usage);
  EXPECT_EQ(statusOf(sphere(), within(-1)), Status::Usage);
}

} // namespace
} // namespace tetvdb
