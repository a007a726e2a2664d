// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/geometry/BoundaryEdgeSums.h"
#include "tetvdb/geometry/TriangleClusters.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace tetvdb {
namespace {

std::vector<FillTriangle> anyTriangles(std::size_t n, std::uint64_t seed) {
  meshes::Random random(seed);
  std::vector<FillTriangle> triangles;
  const auto place = [&](const LatticePoint& c, double size) {
    return LatticePoint{c.x + std::round(random.between(-size, size)),
                        c.y + std::round(random.between(-size, size)),
                        c.z + std::round(random.between(-size, size))};
  };
  for (std::size_t i = 0; i < n; ++i) {
    const LatticePoint c = place({5e8, 0, 0}, 1e8);
    triangles.push_back(
        {place(c, 1e7), place(c, 1e7), place(c, 1e7), 1 + static_cast<std::int32_t>(i % 3)});
  }
  return triangles;
}

TEST(TriangleClusters, HoldEveryTriangleOnce) {
  for (const std::size_t n : {1u, 4u, 5u, 9u, 1000u, 20000u}) {
    const TriangleClusters tree(anyTriangles(n, n));
    ASSERT_EQ(tree.triangleCount(), n);
    EXPECT_EQ(tree.clusters().front().begin, 0u);
    EXPECT_EQ(tree.clusters().front().end, n);
    std::size_t inLeaves = 0;
    for (std::size_t i = 0; i < tree.clusters().size(); ++i) {
      const auto& c = tree.clusters()[i];
      if (c.second == 0) {
        inLeaves += c.end - c.begin;
      } else {
        EXPECT_EQ(tree.clusters()[i + 1].begin, c.begin);
        EXPECT_EQ(tree.clusters()[i + 1].end, tree.clusters()[c.second].begin);
        EXPECT_EQ(tree.clusters()[c.second].end, c.end);
      }
      for (std::uint32_t t = c.begin; t != c.end; ++t)
        for (const LatticePoint& p : {tree.triangle(t).a, tree.triangle(t).b, tree.triangle(t).c}) {
          EXPECT_TRUE(p.x >= c.low.x && p.x <= c.high.x && p.y >= c.low.y && p.y <= c.high.y &&
                      p.z >= c.low.z && p.z <= c.high.z);
          EXPECT_LE(length(from(c.centre, p)), c.radius);
        }
    }
    EXPECT_EQ(inLeaves, n);
  }
}

TEST(TriangleClusters, MomentsAreAsGoodAsTheySay) {
  meshes::Random random(5);
  const TriangleClusters tree(anyTriangles(64, 7));
  double sharpest = 0;
  for (const auto& c : tree.clusters())
    for (int i = 0; i < 40; ++i) {
      Vec3d way{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
      const double away = c.radius * random.between(1.2, 8);
      way = times(way, away / length(way));
      const LatticePoint p{c.centre.x + std::round(way[0]), c.centre.y + std::round(way[1]),
                           c.centre.z + std::round(way[2])};
      double expected = 0;
      for (std::uint32_t t = c.begin; t != c.end; ++t)
        expected += tree.triangle(t).weight * solidAngle(seenFrom(p, tree.triangle(t)));
      const double zero = 0;
      double sum = 0;
      addMoments(c, p, {&zero, &zero, &zero, &sum, 1});
      const double bound = c.momentsError(length(from(p, c.centre)));
      EXPECT_LE(std::abs(sum - expected), bound);
      sharpest = std::max(sharpest, std::abs(sum - expected) / bound);
    }
  EXPECT_GT(sharpest, 0.02) << "the bound is far from sharp";
  EXPECT_EQ(tree.clusters().front().momentsError(0), std::numeric_limits<double>::infinity());
}

} // namespace
} // namespace tetvdb
