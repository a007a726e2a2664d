// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/pipeline/dataset/SamplePoints.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

// Two right triangles, of areas 1 and 3, in the planes z = 0 and z = 1.
TriangleMesh twoTriangles() {
  TriangleMesh mesh;
  mesh.points = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 2, 1}, {3, 0, 1}, {5, 5, 5}};
  mesh.triangles = {0, 1, 2, 3, 4, 5, 6, 6, 6};
  return mesh;
}

TEST(SamplePoints, AreUniformOverTheArea) {
  RandomNumbers random(5);
  constexpr std::size_t kCount = 40000;
  const SurfacePoints samples = sampleSurface(twoTriangles(), kCount, random);
  ASSERT_EQ(samples.points.size(), kCount);
  std::size_t lower = 0;
  double x = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const Vec3d& p = samples.points[i];
    if (p[2] < 0.5) {
      ++lower;
      x += p[0];
      EXPECT_EQ(samples.normals[i], (Vec3d{0, 0, 1}));
      EXPECT_LE(p[0] / 2 + p[1], 1 + 1e-12);
    } else {
      EXPECT_EQ(samples.normals[i], (Vec3d{0, 0, -1}));
      EXPECT_LE(p[0] / 3 + p[1] / 2, 1 + 1e-12);
    }
  }
  // Five standard deviations.
  EXPECT_NEAR(double(lower) / kCount, 0.25, 5 * std::sqrt(0.25 * 0.75 / kCount));
  EXPECT_NEAR(x / double(lower), 2.0 / 3, 5 * std::sqrt(2.0 / 9 / double(lower)));
}

TEST(SamplePoints, SequencesFollowFromTheSeed) {
  RandomNumbers a(1), b(1), c(2);
  const SurfacePoints first = sampleSurface(twoTriangles(), 100, a);
  EXPECT_EQ(first.points, sampleSurface(twoTriangles(), 100, b).points);
  EXPECT_NE(first.points, sampleSurface(twoTriangles(), 100, c).points);
  EXPECT_TRUE(sampleSurface(TriangleMesh{}, 100, a).points.empty());
}

TEST(SamplePoints, NormalDeviatesHaveMeanAndVariance) {
  RandomNumbers random(3);
  constexpr int kCount = 100000;
  double sum = 0, squares = 0;
  Vec3d directions{0, 0, 0};
  for (int i = 0; i < kCount; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
    const Vec3d d = random.direction();
    ASSERT_NEAR(length(d), 1, 1e-12);
    directions = plus(directions, d);
  }
  EXPECT_NEAR(sum / kCount, 0, 5 / std::sqrt(kCount));
  EXPECT_NEAR(squares / kCount, 1, 5 * std::sqrt(2.0 / kCount));
  EXPECT_LT(length(directions) / kCount, 5 / std::sqrt(kCount));
}

} // namespace
} // namespace tetvdb
