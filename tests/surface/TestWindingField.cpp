// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/CompareSolids.h"
#include "tetvdb/surface/SampleBox.h"
#include "tetvdb/surface/WindingCurtain.h"
#include "tetvdb/surface/WindingField.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

TEST(WindingField, EqualsTheSumOfSolidAngles) {
  const TriangleMesh ball = sphere({0, 0, 0}, 1, 6);
  for (const TriangleMesh& mesh :
       {ball, without(ball, [](std::size_t f) { return f % 7 == 0; }),
        without(torus(), [](std::size_t f) { return f < 200; }), sheet(),
        joined({ball, flipped(box()), box({-0.3, -0.3, -0.3}, {2, 0.4, 0.4})})}) {
    const WindingField field(mesh);
    Box box;
    for (const Vec3d& p : mesh.points)
      box.add(p);
    box.add(Vec3d{box.low[0] - 0.5, box.low[1] - 0.5, box.low[2] - 0.5});
    for (std::size_t i = 0; i < 300; ++i) {
      const Vec3d p = pointInBox(box, i);
      EXPECT_NEAR(field.at(p), windingNumberAt(mesh, p), 1e-9);
    }
  }
}

TEST(WindingField, FromFarAway) {
  const TriangleMesh mesh =
      without(sphere({3, 1, 2}, 0.1, 6), [](std::size_t f) { return f > 40; });
  const WindingField field(mesh);
  for (const double distance : {0.3, 1.0, 10.0, 1e3, 1e9}) {
    // Opposite to the ray, where it crosses the mesh, and in other directions.
    for (const Vec3d& way : {kCurtainUp, times(kCurtainUp, -1), Vec3d{1, 0, 0}, Vec3d{0, -1, 1}}) {
      for (std::size_t i = 0; i < 20; ++i) {
        const Vec3d p =
            plus(pointInBox(Box{{2.9, 0.9, 1.9}, {3.1, 1.1, 2.1}}, i), times(way, distance));
        EXPECT_NEAR(field.at(p), windingNumberAt(mesh, p), 1e-9) << distance;
      }
    }
  }
}

TEST(WindingField, ManyBoundaryEdges) {
  const TriangleMesh mesh = without(joined({sphere({0, 0, 0}, 1, 24), sphere({0.7, 0, 0}, 1, 24)}),
                                    [](std::size_t f) { return f % 3 == 0; });
  const WindingField field(mesh);
  EXPECT_EQ(field.anglesPerPoint(), kManyBoundaryEdges);
  Box box;
  for (const Vec3d& p : mesh.points)
    box.add(p);
  for (std::size_t i = 0; i < 300; ++i) {
    const Vec3d p = pointInBox(box, i);
    EXPECT_NEAR(field.at(p), windingNumberAt(mesh, p), kRoughWindingError);
  }
}

TEST(CompareSolids, VolumesLostAndGained) {
  Progress progress;
  const TriangleMesh big = box({0, 0, 0}, {2, 1, 1}), small = box({0, 0, 0}, {1, 1, 1});
  SolidComparison solids = compareSolids(big, small, progress);
  EXPECT_NEAR(solids.before, 2, 0.02);
  EXPECT_NEAR(solids.after, 1, 0.02);
  EXPECT_NEAR(solids.lost, 1, 0.02);
  EXPECT_EQ(solids.gained, 0);
  solids = compareSolids(small, big, progress);
  EXPECT_NEAR(solids.gained, 1, 0.02);
  EXPECT_EQ(solids.lost, 0);
}

TEST(CompareSolids, ThinPartsAreSeenToo) {
  Progress progress;
  // A rod of a thousandth of the box.
  const TriangleMesh rod =
      joined({box({0, 0, 0}, {1, 0.03, 0.03}), box({0, 0.97, 0.97}, {1, 1, 1})});
  const SolidComparison solids = compareSolids(rod, rod, progress);
  EXPECT_NEAR(solids.before, 2 * 0.0009, 0.0002);
  EXPECT_EQ(solids.lost + solids.gained, 0);
  EXPECT_EQ(solids.before, solids.after);
}

} // namespace
} // namespace tetvdb
