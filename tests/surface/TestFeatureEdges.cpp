// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/FeatureEdges.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

TEST(FeatureEdges, OfABoxAreItsTwelveSides) {
  const int n = 5;
  const TriangleMesh mesh = meshes::box({0, 0, 0}, {1, 1, 1}, n);
  const std::vector<VertexPair> found = featureEdges(mesh, 40);
  EXPECT_EQ(found.size(), 12u * n);
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
  for (const VertexPair& edge : found) {
    EXPECT_LT(edge[0], edge[1]);
    for (const std::uint32_t v : edge) { // on two sides of the box at least
      int outside = 0;
      for (const double c : mesh.points[v])
        outside += c == 0 || c == 1;
      EXPECT_GE(outside, 2);
    }
  }
  EXPECT_TRUE(featureEdges(mesh, 95).empty());
}

TEST(FeatureEdges, OfACylinderAreItsTwoCircles) {
  const TriangleMesh mesh = meshes::cylinder(1, 2, 48);
  EXPECT_EQ(featureEdges(mesh, 40).size(), 2u * 48);
  EXPECT_TRUE(featureEdges(meshes::sphere(), 40).empty());
}

TEST(FeatureEdges, OfASheetAreItsBoundary) {
  EXPECT_EQ(featureEdges(meshes::sheet(4), 40).size(), 16u);
}

} // namespace
} // namespace tetvdb
