// SPDX-License-Identifier: Apache-2.0
#include "ManifoldCheck.h"
#include "TriangleMeshes.h"
#include "tetvdb/surface/FloatPositions.h"
#include "tetvdb/surface/SelfIntersections.h"
#include "tetvdb/surface/SeparatePoints.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

TEST(SeparatePoints, SolidsThatTouch) {
  for (const double size : {1e-3, 1.0, 1e5}) {
    // At an edge, at a point.
    for (const Vec3d& at : {Vec3d{1, 1, 0}, Vec3d{1, 1, 1}}) {
      TriangleMesh mesh =
          moved(joined({box(), box(at, {at[0] + 1, at[1] + 1, at[2] + 1})}), [&](const Vec3d& p) {
            return nearestFloats({size * p[0], size * p[1], size * p[2]});
          });
      ASSERT_NE(manifoldDefect(mesh), "");
      const TriangleMesh before = mesh;
      Progress progress;
      const SeparatedPoints counts = separateEqualPoints(mesh, mesh.points.size(), progress);
      EXPECT_TRUE(counts.complete);
      EXPECT_EQ(counts.points, at[2] == 0 ? 2u : 1u);
      EXPECT_EQ(manifoldDefect(mesh), "");
      EXPECT_LT(counts.largestMove, 2e-6 * size);
      EXPECT_EQ(countIntersections(mesh.points, mesh.triangles, 10, progress).pairs, 0u);
      for (std::size_t i = 0; i < 8; ++i) // the first box stays
        EXPECT_EQ(mesh.points[i], before.points[i]);
    }
  }
}

TEST(SeparatePoints, NothingToDo) {
  TriangleMesh mesh = torus();
  const TriangleMesh before = mesh;
  Progress progress;
  EXPECT_EQ(separateEqualPoints(mesh, mesh.points.size(), progress).points, 0u);
  EXPECT_EQ(mesh.points, before.points);
}

} // namespace
} // namespace tetvdb
