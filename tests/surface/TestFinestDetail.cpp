// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/surface/FinestDetail.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

double thicknessOf(const TriangleMesh& mesh) {
  Progress progress;
  return finestThickness(mesh, progress);
}

double voxelOf(const TriangleMesh& mesh, std::size_t maxFaces) {
  Progress progress;
  return voxelForDetail(mesh, maxFaces, progress);
}

TEST(FinestDetail, ThicknessOfPlatesAndShells) {
  EXPECT_NEAR(thicknessOf(box({0, 0, 0}, {4, 3, 0.05})), 0.05, 1e-4);
  EXPECT_NEAR(thicknessOf(joined({sphere({0, 0, 0}, 1, 20), flipped(sphere({0, 0, 0}, 0.9, 20))})),
              0.1, 0.01);
  EXPECT_NEAR(thicknessOf(box()), 1, 1e-4);
  EXPECT_GT(thicknessOf(sheet()), 1e300);
}

TEST(FinestDetail, VoxelsFollowThicknessWithinLimits) {
  const std::size_t many = 100000000;
  EXPECT_NEAR(voxelOf(box({0, 0, 0}, {4, 3, 0.02}), many), 0.02 / 3, 1e-4);
  EXPECT_DOUBLE_EQ(voxelOf(box({0, 0, 0}, {4, 3, 2}), many), 4.0 / 256);
  EXPECT_GT(voxelOf(box({0, 0, 0}, {4, 3, 0.002}), 1000000), 0.002);
  EXPECT_LE(voxelOf(box({0, 0, 0}, {4, 3, 0.002}), 1000), 4.0 / 256);
  TriangleMesh flat = box();
  for (Vec3d& p : flat.points)
    p = {1, 2, 3};
  EXPECT_THROW(voxelOf(flat, many), Error);
}

} // namespace
} // namespace tetvdb
