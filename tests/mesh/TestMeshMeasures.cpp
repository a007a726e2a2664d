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

TEST(MeshMeasures, OfNothing) {
  EXPECT_EQ(areaOf(TriangleMesh()), 0);
  EXPECT_EQ(volumeOf(TriangleMesh()), 0);
}

} // namespace
} // namespace tetvdb
