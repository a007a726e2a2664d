// SPDX-License-Identifier: Apache-2.0
#include "ManifoldCheck.h"
#include "TriangleMeshes.h"
#include "tetvdb/surface/StitchBoundaries.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

StitchCounts stitched(TriangleMesh& mesh) {
  Progress progress;
  return stitchBoundaries(mesh, progress);
}

TEST(StitchBoundaries, NearEndsBecomeOne) {
  // Two halves of a ball whose equators differ by a hundredth of an edge.
  const TriangleMesh ball = sphere({0, 0, 0}, 1, 8);
  const auto upper = [&](std::size_t f) {
    double z = 0;
    for (std::size_t k = 0; k < 3; ++k)
      z += ball.points[ball.triangles[3 * f + k]][2];
    return z > 0;
  };
  TriangleMesh mesh =
      joined({without(ball, upper),
              moved(without(ball, [&](std::size_t f) { return !upper(f); }), [](const Vec3d& p) {
                return Vec3d{p[0] + 1e-3, p[1], p[2]};
              })});
  const StitchCounts counts = stitched(mesh);
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_EQ(counts.joinedPoints, 32u);
  EXPECT_NEAR(counts.largestMove, 1e-3, 1e-12);
  EXPECT_EQ(counts.splitFaces, 0u);
  EXPECT_EQ(mesh.triangleCount(), ball.triangleCount());
}

TEST(StitchBoundaries, VerticesOnEdgesSplitTheirFaces) {
  // A lid of 3 x 3 squares on a box of 2 x 2: 8 edges of the box are met at a third, 4 of the lid
  // in their middle.
  const TriangleMesh coarse = box({0, 0, 0}, {1, 1, 1}, 2), fine = box({0, 0, 0}, {1, 1, 1}, 3);
  TriangleMesh mesh = joined({without(coarse, [](std::size_t f) { return f >= 40; }),
                              without(fine, [](std::size_t f) { return f < 90; })});
  const StitchCounts counts = stitched(mesh);
  EXPECT_EQ(counts.largestMove, 0);
  EXPECT_EQ(counts.splitFaces, 8u + 4);
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_NEAR(signedVolume(mesh), 1, 1e-14);
  EXPECT_EQ(eulerCharacteristic(mesh), 2);
}

TEST(StitchBoundaries, CollinearFacesAreFlipped) {
  TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1}, 2);
  // A point in the middle of an edge, for one of its faces alone: between them a face without area.
  const std::uint32_t a = mesh.triangles[0], b = mesh.triangles[1], c = mesh.triangles[2];
  const auto midpoint = static_cast<std::uint32_t>(mesh.points.size());
  Vec3d p;
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = (mesh.points[a][k] + mesh.points[b][k]) / 2;
  mesh.points.push_back(p);
  mesh.triangles[1] = midpoint;
  addTriangle(mesh, midpoint, b, c);
  addTriangle(mesh, a, b, midpoint);
  ASSERT_EQ(manifoldDefect(mesh), "");
  const StitchCounts counts = stitched(mesh);
  EXPECT_EQ(counts.flippedFaces, 1u);
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_NEAR(signedVolume(mesh), 1, 1e-14);
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const Vec3d &u = mesh.points[mesh.triangles[i]], &v = mesh.points[mesh.triangles[i + 1]],
                &w = mesh.points[mesh.triangles[i + 2]];
    double area = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t m = (k + 1) % 3, n = (k + 2) % 3;
      area += std::abs((v[m] - u[m]) * (w[n] - u[n]) - (v[n] - u[n]) * (w[m] - u[m]));
    }
    EXPECT_GT(area, 0.1);
  }
}

TEST(StitchBoundaries, HolesAndSlitsOfSomeWidthStay) {
  const TriangleMesh torn =
      without(torus(), [](std::size_t f) { return f % 50 == 7 || f % 50 == 30; });
  TriangleMesh mesh = torn;
  const StitchCounts counts = stitched(mesh);
  EXPECT_EQ(counts.joinedPoints + counts.splitFaces + counts.flippedFaces, 0u);
  EXPECT_EQ(mesh.triangles, torn.triangles);
  EXPECT_EQ(mesh.points, torn.points);
}

} // namespace
} // namespace tetvdb
