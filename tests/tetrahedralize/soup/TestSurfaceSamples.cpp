// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/tetrahedralize/soup/SurfaceSamples.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

TEST(SurfaceSamples, LieOnTheirTrianglesAsManyAsTheirArea) {
  // Two triangles over the unit square's diagonal, one of which is a thousandth as high, and one
  // of no area.
  TriangleMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, -1e-3, 0}, {0.5, 0, 0}};
  mesh.triangles = {0, 1, 2, 0, 3, 1, 0, 4, 1};
  const std::size_t n = 20000;
  std::array<std::size_t, 3> count{0, 0, 0};
  std::size_t quarter = 0;
  for (const SurfaceSample& sample : sampleSurface(mesh, n, false)) {
    ASSERT_LT(sample.triangle, 2u);
    ++count[sample.triangle];
    const auto [x, y, z] = sample.at;
    EXPECT_EQ(z, 0);
    if (sample.triangle == 0) {
      EXPECT_TRUE(x >= y && y >= 0 && x <= 1) << x << ' ' << y;
      quarter += x <= 0.5 ? 1 : 0;
    } else {
      EXPECT_TRUE(x <= 1 && y <= 0 && y >= -1e-3 * x - 1e-15) << x << ' ' << y;
    }
  }
  EXPECT_NEAR(double(count[0] + count[1]), double(n), 1);
  EXPECT_NEAR(double(count[1]), double(n) / 1001, 2);
  EXPECT_NEAR(double(quarter), double(n) / 4, double(n) / 200);
}

TEST(SurfaceSamples, HaveEveryCentroid) {
  TriangleMesh mesh = meshes::sphere({1, 2, 3}, 2, 4);
  meshes::addTriangle(mesh, 0, 1, 1);
  std::vector<std::size_t> found(mesh.triangleCount(), 0);
  for (const SurfaceSample& sample : sampleSurface(mesh, 10, true)) {
    double off = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k)
        sum += mesh.points[mesh.triangles[3 * sample.triangle + k]][axis];
      off = std::max(off, std::abs(sample.at[axis] - sum / 3));
    }
    found[sample.triangle] += off < 1e-12 ? 1 : 0;
  }
  for (std::size_t t = 0; t + 1 < found.size(); ++t)
    EXPECT_EQ(found[t], 1u);
  EXPECT_EQ(found.back(), 0u);
}

TEST(SurfaceSamples, PointsInABoxAreEvenlySpread) {
  const Box box{{-1, 2, 5}, {1, 6, 6}};
  constexpr std::size_t kParts = 4, n = 64000;
  std::array<std::size_t, kParts * kParts * kParts> count{};
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d p = pointInBox(box, i);
    ASSERT_TRUE(box.contains(p));
    std::size_t part = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double along = (p[axis] - box.low[axis]) / (box.high[axis] - box.low[axis]);
      part = kParts * part + std::min(static_cast<std::size_t>(along * kParts), kParts - 1);
    }
    ++count[part];
  }
  for (const std::size_t c : count)
    EXPECT_NEAR(double(c), 1000, 60);
}

TEST(SurfaceSamples, NoneOfNoArea) {
  TriangleMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
  mesh.triangles = {0, 1, 2};
  EXPECT_TRUE(sampleSurface(mesh, 100, true).empty());
  EXPECT_TRUE(sampleSurface({}, 100, true).empty());
}

} // namespace
} // namespace tetvdb
