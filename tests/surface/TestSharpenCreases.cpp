// SPDX-License-Identifier: Apache-2.0
#include "ManifoldCheck.h"
#include "TriangleMeshes.h"
#include "tetvdb/surface/CompareMeshes.h"
#include "tetvdb/surface/ExtractSurface.h"
#include "tetvdb/surface/SelfIntersections.h"
#include "tetvdb/surface/TriangleScene.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <cmath>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

// About z, then about x, by angles without a meaning.
TriangleMesh turned(TriangleMesh mesh) {
  for (Vec3d& p : mesh.points) {
    p = {std::cos(0.5) * p[0] - std::sin(0.5) * p[1], std::sin(0.5) * p[0] + std::cos(0.5) * p[1],
         p[2]};
    p = {p[0], std::cos(0.3) * p[1] - std::sin(0.3) * p[2],
         std::sin(0.3) * p[1] + std::cos(0.3) * p[2]};
  }
  return mesh;
}

struct Made {
  TriangleMesh mesh;
  double voxel = 0;
  MeshDistance distance; ///< in voxels, of the original (a) and what was made of it
};

Made remeshed(const TriangleMesh& original, int resolution, double simplify = 0.1,
              const Vec3d& origin = {0, 0, 0}) {
  Report report;
  Progress progress;
  VoxelizeOptions options;
  options.grids = {GridKind::Mask};
  options.resolution = resolution;
  options.origin = origin;
  const Voxelization voxels = voxelize(original, {}, options, report, progress);
  const TriangleScene scene(original);
  ExtractOptions extract;
  extract.original = &scene;
  extract.simplify = simplify;
  Made made;
  made.mesh = extractSurface(voxels.volume, extract, progress);
  made.voxel = voxels.transform.voxelSize[0];
  EXPECT_EQ(manifoldDefect(made.mesh), "");
  made.distance = compareMeshes(original, made.mesh, {}, progress);
  made.distance.aToB.largest /= made.voxel;
  made.distance.bToA.largest /= made.voxel;
  return made;
}

TEST(SharpenCreases, ABoxBetweenVoxelCentresComesBackExactly) {
  const TriangleMesh cube = box({0, 0, 0}, {1, 1, 1});
  const Made made = remeshed(cube, 32, 0.1, {-0.38 / 32, -0.38 / 32, -0.38 / 32});
  EXPECT_EQ(made.mesh.triangleCount(), 12u);
  EXPECT_LT(made.distance.aToB.largest, 1e-4);
  EXPECT_LT(made.distance.bToA.largest, 1e-4);
}

TEST(SharpenCreases, EdgesAndCornersInAnyDirection) {
  const Made made = remeshed(turned(box({0, 0, 0}, {1, 0.8, 0.6})), 48);
  EXPECT_LT(made.distance.aToB.largest, 0.1); // corners are cut off by a voxel without
  EXPECT_LT(made.distance.bToA.largest, 0.1);
  EXPECT_LT(made.mesh.triangleCount(), 150u);
  EXPECT_NEAR(signedVolume(made.mesh), 0.48, 0.48e-3);
  EXPECT_EQ(eulerCharacteristic(made.mesh), 2);
  EXPECT_EQ(crossingsOf(made.mesh), 0u);
}

TEST(SharpenCreases, CurvedEdges) {
  const Made made = remeshed(turned(cylinder(1, 2, 64)), 48);
  EXPECT_LT(made.distance.aToB.largest, 0.15);
  EXPECT_LT(made.distance.bToA.largest, 0.15);
  EXPECT_EQ(eulerCharacteristic(made.mesh), 2);
}

TEST(SharpenCreases, InnerCornersOfABracket) {
  const TriangleMesh bracket =
      turned(joined({box({0, 0, 0}, {3, 1, 0.4}), box({0.001, 0.001, 0.001}, {0.4, 0.999, 2})}));
  const Made made = remeshed(bracket, 60);
  EXPECT_LT(made.distance.bToA.rms, 0.02 * made.voxel);
  EXPECT_LT(made.mesh.triangleCount(), 300u);
  EXPECT_EQ(crossingsOf(made.mesh), 0u);
}

TEST(SharpenCreases, AnythingStaysManifold) {
  Random random(11);
  for (int round = 0; round < 3; ++round) {
    TriangleMesh crowd;
    for (int i = 0; i < 25; ++i) {
      const Vec3d low{random.unit(), random.unit(), random.unit()};
      append(crowd, turned(box(low, {low[0] + random.between(0.01, 0.3),
                                     low[1] + random.between(0.01, 0.3),
                                     low[2] + random.between(0.01, 0.3)})));
    }
    remeshed(crowd, 30, 0);
    remeshed(crowd, 30, 0.1);
  }
}

TEST(SharpenCreases, TheSameForAnyNumberOfThreads) {
  const TriangleMesh original = turned(box({0, 0, 0}, {1, 0.8, 0.6}));
  TriangleMesh one, two;
  tbb::task_arena(1).execute([&] { one = remeshed(original, 40, 0).mesh; });
  tbb::task_arena(4).execute([&] { two = remeshed(original, 40, 0).mesh; });
  EXPECT_EQ(one.points, two.points);
  EXPECT_EQ(one.triangles, two.triangles);
}

} // namespace
} // namespace tetvdb
