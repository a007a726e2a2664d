// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/FacesOfPoints.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

std::vector<std::vector<std::uint32_t>> listsOf(const TriangleMesh& mesh, int threads) {
  std::vector<std::vector<std::uint32_t>> lists(mesh.points.size());
  tbb::task_arena(threads).execute([&] {
    const FacesOfPoints facesOf(mesh);
    for (std::size_t point = 0; point < lists.size(); ++point)
      for (const std::uint32_t face : facesOf(point))
        lists[point].push_back(face);
  });
  return lists;
}

TEST(FacesOfPoints, AreThoseWithTheCornerAscending) {
  const TriangleMesh mesh = meshes::sphere({0, 0, 0}, 1, 64);
  std::vector<std::vector<std::uint32_t>> expected(mesh.points.size());
  for (std::uint32_t face = 0; face < mesh.triangleCount(); ++face)
    for (std::size_t k = 0; k < 3; ++k)
      expected[mesh.triangles[3 * std::size_t(face) + k]].push_back(face);
  EXPECT_EQ(listsOf(mesh, 1), expected);
  EXPECT_EQ(listsOf(mesh, 4), expected);
}

TEST(FacesOfPoints, PointsWithoutFaces) {
  TriangleMesh mesh;
  EXPECT_TRUE(listsOf(mesh, 1).empty());
  mesh.points.resize(4);
  mesh.triangles = {3, 1, 3};
  EXPECT_EQ(listsOf(mesh, 1), (std::vector<std::vector<std::uint32_t>>{{}, {0}, {}, {0, 0}}));
}

} // namespace
} // namespace tetvdb
