// SPDX-License-Identifier: Apache-2.0
#include "ManifoldCheck.h"
#include "TriangleMeshes.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/JoinPoints.h"

#include <gtest/gtest.h>
#include <numeric>

namespace tetvdb {
namespace {

using meshes::box;
using meshes::joined;
using meshes::manifoldDefect;
using meshes::sphere;

// Divides a face at a point near its first corner: three faces, one of them with a short edge.
void divideNearCorner(TriangleMesh& mesh, std::uint32_t face, double distance) {
  const std::uint32_t a = mesh.triangles[3 * face], b = mesh.triangles[3 * face + 1],
                      c = mesh.triangles[3 * face + 2];
  const Vec3d to = times(plus(mesh.points[b], mesh.points[c]), 0.5);
  const Vec3d way = minus(to, mesh.points[a]);
  const auto p = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.push_back(plus(mesh.points[a], times(way, distance / length(way))));
  mesh.triangles[3 * face + 2] = p;
  for (const std::uint32_t v : {b, c, p, c, a, p})
    mesh.triangles.push_back(v);
  mesh.faceCount = mesh.triangleCount();
}

TEST(JoinPoints, ShortEdgesAreContractedAndOthersStay) {
  const TriangleMesh ball = sphere({0, 0, 0}, 1, 8);
  TriangleMesh mesh = ball;
  const std::size_t faces = mesh.triangleCount();
  divideNearCorner(mesh, 3, 1e-5);
  divideNearCorner(mesh, 40, 4e-5);
  divideNearCorner(mesh, 77, 1e-2);
  ASSERT_EQ(manifoldDefect(mesh), "");
  const ContractedEdges contracted = contractShortEdges(mesh, mesh.triangles, 1e-4);
  EXPECT_EQ(contracted.edges, 2u);
  EXPECT_NEAR(contracted.longest, 4e-5, 1e-12);
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_EQ(mesh.triangleCount(), faces + 2); // of the face that was divided far from its corner
  EXPECT_EQ(mesh.points.size(), ball.points.size() + 1);
  for (std::size_t i = 0; i < ball.points.size(); ++i)
    EXPECT_EQ(mesh.points[i], ball.points[i]);
}

TEST(JoinPoints, OnlyEdgesOfTheGivenFaces) {
  TriangleMesh mesh = sphere({0, 0, 0}, 1, 8);
  divideNearCorner(mesh, 3, 1e-5);
  const TriangleMesh before = mesh;
  const std::uint32_t* far = &before.triangles[3 * 60];
  EXPECT_EQ(contractShortEdges(mesh, {far[0], far[1], far[2]}, 1e-4).edges, 0u);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

TEST(JoinPoints, AFlattenedSolidVanishes) {
  // Its faces cancel in pairs.
  TriangleMesh mesh = joined({sphere({0, 0, 0}, 1, 8), box({2, 2, 2}, {3, 3, 2.00001})});
  const std::size_t ofBall = sphere({0, 0, 0}, 1, 8).triangleCount();
  const TriangleMesh before = mesh;
  std::vector<std::uint32_t> becomes(mesh.points.size());
  std::iota(becomes.begin(), becomes.end(), 0u);
  for (std::uint32_t a = 0; a < before.points.size(); ++a)
    for (std::uint32_t b = 0; b < a; ++b)
      if (length(minus(before.points[a], before.points[b])) < 1e-4)
        becomes[a] = b;
  joinPoints(mesh, becomes);
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_EQ(mesh.triangleCount(), ofBall);
}

} // namespace
} // namespace tetvdb
