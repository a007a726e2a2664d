// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/surface/WeldBoundary.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using namespace meshes;

TriangleMesh apart(const TriangleMesh& mesh, double noise) {
  Random random(3);
  return moved(unwelded(mesh), [&](Vec3d p) {
    for (double& coordinate : p)
      coordinate += random.between(-noise, noise);
    return p;
  });
}

BoundaryWeld weld(const TriangleMesh& mesh) {
  Progress progress;
  return weldBoundary(mesh, EdgeTable(mesh), WeldCandidates::BoundaryPoints, progress);
}

TEST(WeldBoundary, PointsThatDifferByRoundingCloseTheMesh) {
  for (const TriangleMesh& mesh : {box(), box({0, 0, 0}, {1, 1, 1}, 10), sphere(), torus()})
    for (const double noise : {1e-9, 1e-7, 1e-6, 1e-5}) {
      TriangleMesh soup = apart(mesh, noise);
      Progress progress;
      const CleanCounts counts = cleanTriangles(soup, {}, progress);
      EXPECT_EQ(soup.points.size(), mesh.points.size()) << noise;
      EXPECT_EQ(soup.triangleCount(), mesh.triangleCount());
      EXPECT_GT(counts.weldDistance, 0);
      EXPECT_LE(counts.weldDistance, 2 * std::sqrt(3.0) * noise);
      const EdgeTable edges(soup);
      for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
        ASSERT_EQ(edges.sides(edge).size(), 2u);
    }
}

// Faces as small as the gaps elsewhere: their corners stay apart.
TEST(WeldBoundary, FineDetailIsNotMerged) {
  TriangleMesh mesh = apart(box({0, 0, 0}, {1, 1, 1}, 4), 1e-6);
  const std::size_t coarse = mesh.triangleCount();
  append(mesh, without(box({2, 2, 2}, {2.00001, 2.00001, 2.00001}, 4),
                       [](std::size_t face) { return face % 7 == 0; }));
  const std::size_t fine = mesh.triangleCount() - coarse;
  Progress progress;
  cleanTriangles(mesh, {}, progress);
  EXPECT_EQ(mesh.triangleCount(), coarse + fine);
}

// Two squares whose boundaries lie near one another, with points in other places.
TEST(WeldBoundary, NothingIsWeldedThatClosesNoEdge) {
  TriangleMesh mesh = sheet(4, 0);
  append(mesh, moved(sheet(4, 1), [](Vec3d p) {
           const bool corner = p[0] < 0.1 && p[1] < 0.1;
           return corner ? Vec3d{1e-6, 0, 0} : Vec3d{p[0] + 3, p[1], 1};
         }));
  EXPECT_TRUE(weld(mesh).becomes.empty());
}

TEST(WeldBoundary, ClosedMeshesAndZeroAreLeft) {
  EXPECT_TRUE(weld(box()).becomes.empty());
  TriangleMesh soup = apart(box(), 1e-6);
  CleanOptions options;
  options.weldDistance = 0;
  Progress progress;
  EXPECT_EQ(cleanTriangles(soup, options, progress).weldDistance, 0);
  EXPECT_EQ(soup.points.size(), 36u);
}

} // namespace
} // namespace tetvdb
