// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/BoundaryLoops.h"
#include "tetvdb/surface/EdgeTable.h"

#include <gtest/gtest.h>
#include <map>
#include <set>
#include <utility>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

// Loops pass no point twice, and with them every edge is balanced.
std::vector<BoundaryLoop> loopsOf(const TriangleMesh& mesh) {
  const EdgeTable edges(mesh);
  std::vector<BoundaryLoop> loops = findBoundaryLoops(mesh, edges);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> excess;
  const auto run = [&](std::uint32_t a, std::uint32_t b) {
    ++excess[{a, b}];
    --excess[{b, a}];
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    run(mesh.triangles[i], mesh.triangles[i % 3 == 2 ? i - 2 : i + 1]);
  for (const BoundaryLoop& loop : loops) {
    EXPECT_EQ(std::set<std::uint32_t>(loop.points.begin(), loop.points.end()).size(),
              loop.points.size());
    for (std::size_t i = 0; i < loop.points.size(); ++i) {
      const std::uint32_t a = loop.points[i], b = loop.points[(i + 1) % loop.points.size()];
      run(a, b);
      EXPECT_EQ(mesh.triangles[loop.sides[i]], b);
      EXPECT_EQ(mesh.triangles[EdgeTable::next(loop.sides[i])], a);
    }
  }
  for (const auto& [edge, sum] : excess)
    EXPECT_EQ(sum, 0);
  return loops;
}

TEST(BoundaryLoops, ClosedMeshesHaveNone) {
  EXPECT_TRUE(loopsOf(torus()).empty());
}

TEST(BoundaryLoops, TubesHaveTwo) {
  const std::vector<BoundaryLoop> loops = loopsOf(cylinder(1, 1, 17, false));
  ASSERT_EQ(loops.size(), 2u);
  EXPECT_EQ(loops[0].points.size(), 17u);
}

TEST(BoundaryLoops, HolesByChance) {
  Random random(2);
  for (const double share : {0.02, 0.2, 0.6}) {
    std::vector<char> drops(2000, 0);
    for (char& drop : drops)
      drop = random.unit() < share;
    const TriangleMesh mesh =
        without(torus(1, 0.4, 40, 25), [&](std::size_t f) { return drops[f] != 0; });
    EXPECT_GT(loopsOf(mesh).size(), 10u);
  }
}

TEST(BoundaryLoops, EdgesOfThreeFaces) {
  TriangleMesh mesh = box();
  const auto top = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.push_back({3, 3, 3});
  addTriangle(mesh, mesh.triangles[0], mesh.triangles[1], top);
  EXPECT_EQ(loopsOf(mesh).size(), 1u);
}

} // namespace
} // namespace tetvdb
