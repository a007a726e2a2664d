// SPDX-License-Identifier: Apache-2.0
#include "ManifoldCheck.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/surface/SelfIntersections.h"
#include "tetvdb/surface/SmoothSurface.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

TriangleMesh noisy(TriangleMesh mesh, double amount) {
  Random random(7);
  for (Vec3d& p : mesh.points)
    for (double& c : p)
      c += random.between(-amount, amount);
  return mesh;
}

SmoothCounts smooth(TriangleMesh& mesh, double distance, double featureDegrees = 40) {
  Progress progress;
  SmoothOptions options;
  options.distance = distance;
  options.featureDegrees = featureDegrees;
  return smoothSurface(mesh, options, progress);
}

double roughness(const TriangleMesh& ball) { // of a ball of radius 1: rms of the radius's error
  double sum = 0;
  for (const Vec3d& p : ball.points)
    sum += std::pow(std::hypot(p[0], p[1], p[2]) - 1, 2);
  return std::sqrt(sum / static_cast<double>(ball.points.size()));
}

double farthest(const TriangleMesh& a, const TriangleMesh& b) {
  double far = 0;
  for (std::size_t v = 0; v < a.points.size(); ++v)
    far = std::max(far, std::hypot(a.points[v][0] - b.points[v][0], a.points[v][1] - b.points[v][1],
                                   a.points[v][2] - b.points[v][2]));
  return far;
}

TEST(SmoothSurface, NoiseGoesAndTheVolumeStays) {
  const TriangleMesh before = noisy(sphere({0, 0, 0}, 1, 24), 0.01);
  ASSERT_EQ(crossingsOf(before), 0u);
  TriangleMesh mesh = before;
  const SmoothCounts counts = smooth(mesh, 0.05, 180);
  EXPECT_LT(roughness(mesh), 0.45 * roughness(before));
  EXPECT_NEAR(signedVolume(mesh), signedVolume(before), 1.001e-3 * signedVolume(before));
  EXPECT_EQ(mesh.triangles, before.triangles);
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_EQ(crossingsOf(mesh), 0u);
  EXPECT_NEAR(counts.largest, farthest(before, mesh), 1e-12);
  EXPECT_EQ(counts.moved, mesh.points.size());
}

TEST(SmoothSurface, NoVertexMovesFartherThanAllowed) {
  const TriangleMesh before = noisy(sphere({0, 0, 0}, 1, 24), 0.01);
  for (const double distance : {0.001, 0.004}) {
    TriangleMesh mesh = before;
    smooth(mesh, distance, 180);
    EXPECT_LE(farthest(before, mesh), distance * (1 + 1e-9));
    EXPECT_GT(farthest(before, mesh), distance * 0.9);
    EXPECT_LT(roughness(mesh), roughness(before));
  }
}

TEST(SmoothSurface, FeatureEdgesStay) {
  const TriangleMesh before = box({0, 0, 0}, {1, 1, 1}, 10);
  TriangleMesh dented = before;
  for (Vec3d& p : dented.points)
    if (p[0] > 0 && p[0] < 1 && p[1] > 0 && p[1] < 1)
      p[2] += 0.01 * std::sin(40 * p[0] + 50 * p[1]);
  TriangleMesh mesh = dented;
  const SmoothCounts counts = smooth(mesh, 0.05);
  EXPECT_EQ(counts.held, 12u * 10 - 4);
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    int outside = 0;
    for (const double c : before.points[v])
      outside += c == 0 || c == 1;
    if (outside >= 2) {
      EXPECT_EQ(mesh.points[v], dented.points[v]);
    }
  }
  double before2 = 0, after2 = 0;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    before2 += std::pow(dented.points[v][2] - before.points[v][2], 2);
    after2 += before.points[v][2] == 0 || before.points[v][2] == 1
                  ? std::pow(mesh.points[v][2] - before.points[v][2], 2)
                  : 0;
  }
  EXPECT_LT(after2, before2 / 4);
}

TEST(SmoothSurface, WallsThatAreNearDoNotCross) {
  const TriangleMesh before = joined({noisy(sphere({0, 0, 0}, 1, 20), 0.004),
                                      flipped(noisy(sphere({0, 0, 0}, 0.988, 13), 0.001))});
  ASSERT_EQ(crossingsOf(before), 0u);
  TriangleMesh mesh = before;
  smooth(mesh, 0.2, 180);
  EXPECT_EQ(crossingsOf(mesh), 0u);
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_NEAR(signedVolume(mesh), signedVolume(before), 1.001e-3 * signedVolume(before));
}

TEST(SmoothSurface, RefusesWhatItCannotSmooth) {
  const auto statusOf = [](TriangleMesh mesh, double distance) {
    try {
      smooth(mesh, distance);
    } catch (const Error& error) {
      return error.status();
    }
    return Status::Ok;
  };
  EXPECT_EQ(statusOf(sheet(3), 1), Status::Invalid);
  EXPECT_EQ(statusOf(sphere(), 0), Status::Usage);
  EXPECT_EQ(statusOf(sphere(), std::nan("")), Status::Usage);
  EXPECT_EQ(statusOf(TriangleMesh(), 1), Status::Ok);
}

} // namespace
} // namespace tetvdb
