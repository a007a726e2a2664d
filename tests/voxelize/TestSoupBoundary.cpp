// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/voxelize/SoupBoundary.h"

#include <gtest/gtest.h>
#include <map>
#include <random>
#include <utility>

namespace tetvdb {
namespace {

// Counts every directed edge of every face.
SoupBoundary countedBoundary(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<int, int>> edges; // sum, count
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[t + k], b = mesh.triangles[t + (k + 1) % 3];
      if (a == b)
        continue;
      auto& [sum, count] = edges[std::minmax(a, b)];
      sum += a < b ? 1 : -1;
      ++count;
    }
  SoupBoundary boundary;
  for (const auto& [edge, sums] : edges) {
    if (sums.first > 0)
      boundary.edges.push_back({edge.first, edge.second, sums.first});
    else if (sums.first < 0)
      boundary.edges.push_back({edge.second, edge.first, -sums.first});
    boundary.oddEdges += static_cast<std::size_t>(sums.second % 2);
  }
  return boundary;
}

void expectCounted(const TriangleMesh& mesh) {
  Progress progress;
  const SoupBoundary made = soupBoundary(mesh, progress), expected = countedBoundary(mesh);
  EXPECT_EQ(made.oddEdges, expected.oddEdges);
  ASSERT_EQ(made.edges.size(), expected.edges.size());
  for (std::size_t i = 0; i < made.edges.size(); ++i) {
    EXPECT_EQ(made.edges[i].a, expected.edges[i].a);
    EXPECT_EQ(made.edges[i].b, expected.edges[i].b);
    EXPECT_EQ(made.edges[i].weight, expected.edges[i].weight);
  }
}

TEST(SoupBoundary, IsTheSumOfDirectedEdges) {
  std::mt19937 random(1);
  for (const std::uint32_t points : {3u, 5u, 20u, 1000u}) {
    TriangleMesh mesh; // with repeated faces, and faces with repeated points
    mesh.points.resize(points);
    std::uniform_int_distribution<std::uint32_t> any(0, points - 1);
    for (int i = 0; i < 40000; ++i)
      meshes::addTriangle(mesh, any(random), any(random), any(random));
    expectCounted(mesh);
  }
}

TEST(SoupBoundary, OfAClosedMeshIsEmpty) {
  Progress progress;
  TriangleMesh mesh = meshes::sphere({0, 0, 0}, 1, 20);
  EXPECT_TRUE(soupBoundary(mesh, progress).edges.empty());
  EXPECT_EQ(soupBoundary(mesh, progress).oddEdges, 0u);
  mesh.triangles.resize(mesh.triangles.size() - 3);
  EXPECT_EQ(soupBoundary(mesh, progress).edges.size(), 3u);
  expectCounted(mesh);
}

} // namespace
} // namespace tetvdb
