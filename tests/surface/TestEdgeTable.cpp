// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/EdgeTable.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <tbb/task_arena.h>
#include <utility>

namespace tetvdb {
namespace {

// Edges with their sides, by a map.
std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>>
sidesByMap(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> edges;
  for (std::uint32_t face = 0; face < mesh.triangleCount(); ++face) {
    const std::uint32_t* v = &mesh.triangles[3 * face];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
      continue;
    for (std::uint32_t k = 0; k < 3; ++k)
      edges[std::minmax(v[k], v[(k + 1) % 3])].push_back(3 * face + k);
  }
  return edges;
}

void expectAgreesWithMap(const TriangleMesh& mesh) {
  const auto expected = sidesByMap(mesh);
  const EdgeTable edges(mesh);
  ASSERT_EQ(edges.edgeCount(), expected.size());
  std::uint32_t edge = 0;
  for (const auto& [points, sides] : expected) { // a map is in the order of (low, high) too
    ASSERT_EQ(std::make_pair(edges.lowPoint(edge), edges.highPoint(edge)), points);
    const EdgeTable::Sides got = edges.sides(edge);
    ASSERT_EQ(std::vector<std::uint32_t>(got.begin(), got.end()), sides);
    for (const std::uint32_t side : sides) {
      EXPECT_EQ(edges.edgeOf(side), edge);
      EXPECT_EQ(edges.ascends(side), mesh.triangles[side] == points.first);
      const std::uint32_t apex = edges.opposite(side);
      EXPECT_TRUE(apex != points.first && apex != points.second);
    }
    ++edge;
  }
}

TEST(EdgeTable, AgreesWithAMap) {
  expectAgreesWithMap(meshes::sphere({0, 0, 0}, 1, 40));
  expectAgreesWithMap(meshes::moebius());
  expectAgreesWithMap(meshes::unwelded(meshes::torus()));
  expectAgreesWithMap(TriangleMesh{});
  meshes::Random random(3);
  for (int round = 0; round < 20; ++round) { // many faces at few points
    TriangleMesh mesh;
    mesh.points.resize(12);
    for (int corner = 0; corner < 3 * 400; ++corner)
      mesh.triangles.push_back(static_cast<std::uint32_t>(random.below(12)));
    expectAgreesWithMap(mesh);
  }
}

TEST(EdgeTable, LeavesOutFacesWithARepeatedPoint) {
  TriangleMesh mesh = meshes::box();
  meshes::addTriangle(mesh, 0, 1, 0);
  meshes::addTriangle(mesh, 2, 2, 2);
  const EdgeTable edges(mesh);
  EXPECT_EQ(edges.edgeCount(), 18u);
  EXPECT_TRUE(edges.hasFace(11));
  EXPECT_FALSE(edges.hasFace(12));
  EXPECT_FALSE(edges.hasFace(13));
}

TEST(EdgeTable, SidesOfAFaceFollowOneAnother) {
  EXPECT_EQ(EdgeTable::next(3), 4u);
  EXPECT_EQ(EdgeTable::next(5), 3u);
  EXPECT_EQ(EdgeTable::previous(3), 5u);
  EXPECT_EQ(EdgeTable::previous(5), 4u);
  EXPECT_EQ(EdgeTable::faceOf(5), 1u);
}

TEST(EdgeTable, IsTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = meshes::shuffledFaces(meshes::cylinder(1, 1, 30000));
  const auto sidesWith = [&](int threads) {
    std::vector<std::uint32_t> sides;
    tbb::task_arena(threads).execute([&] {
      const EdgeTable edges(mesh);
      for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
        sides.insert(sides.end(), edges.sides(edge).begin(), edges.sides(edge).end());
    });
    return sides;
  };
  EXPECT_EQ(sidesWith(1), sidesWith(4));
}

} // namespace
} // namespace tetvdb
