// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/mesh/MeshMeasures.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

TEST(MeshMeasures, OfABox) {
  const TriangleMesh box = meshes::box({1, 2, 3}, {3, 5, 7}, 4);
  EXPECT_NEAR(areaOf(box), 2 * (2 * 3 + 3 * 4 + 4 * 2), 1e-12);
  EXPECT_NEAR(volumeOf(box), 2 * 3 * 4, 1e-12);
  EXPECT_NEAR(volumeOf(meshes::flipped(box)), -2 * 3 * 4, 1e-12);
}

TEST(MeshMeasures, DoNotDependOnTheOriginByMuch) {
  const TriangleMesh box = meshes::box({1e6, 1e6, 1e6}, {1e6 + 1, 1e6 + 1, 1e6 + 1}, 3);
  EXPECT_NEAR(volumeOf(box), 1, 1e-9);
  EXPECT_NEAR(areaOf(box), 6, 1e-9);
}

TEST(MeshMeasures, TheBoxIsOfUsedPoints) {
  const std::vector<Vec3d> points{{1, 5, 2}, {-9, 9, 9}, {3, 4, 2}};
  Box box = boxOf(points, {0, 2, 2});
  EXPECT_EQ(box.low, (Vec3d{1, 4, 2}));
  EXPECT_EQ(box.high, (Vec3d{3, 5, 2}));
  box.add(boxOf(points, {})); // an empty box
  EXPECT_EQ(box.low, (Vec3d{1, 4, 2}));
  EXPECT_EQ(box.high, (Vec3d{3, 5, 2}));
  box.add(boxOf(points, {1}));
  EXPECT_EQ(box.low, (Vec3d{-9, 4, 2}));
  EXPECT_EQ(box.high, (Vec3d{3, 9, 9}));
}

TEST(MeshMeasures, OfNothing) {
  EXPECT_EQ(areaOf(TriangleMesh()), 0);
  EXPECT_EQ(volumeOf(TriangleMesh()), 0);
}

} // namespace
} // namespace tetvdb
