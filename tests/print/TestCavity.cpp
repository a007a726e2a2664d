// SPDX-License-Identifier: Apache-2.0
#include "MeshOracles.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/print/Cavity.h"
#include "tetvdb/surface/LocalRepair.h"
#include "tetvdb/surface/SimplifySurface.h"

#include <cmath>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

Cavity cavityOf(const TriangleMesh& solid, double wall, double voxel, double close = 0,
                int threads = 0) {
  CavityOptions options;
  options.wall = wall;
  options.voxel = voxel;
  options.close = close;
  Report report;
  Progress progress;
  if (threads == 0)
    return makeCavity(solid, options, report, progress);
  tbb::task_arena arena(threads);
  return arena.execute([&] { return makeCavity(solid, options, report, progress); });
}

TriangleMesh asFloats(TriangleMesh mesh) {
  for (Vec3d& p : mesh.points)
    for (double& x : p)
      x = static_cast<double>(static_cast<float>(x));
  return mesh;
}

// The wall is at most a few hundredths of a voxel thicker than it says, and never thinner.
void expectWall(const TriangleMesh& solid, const Cavity& cavity, double wall, double voxel,
                std::size_t step = 1) {
  EXPECT_TRUE(oracles::isClosedManifold(cavity.surface));
  const double distance = oracles::distanceBetween(asFloats(cavity.surface), solid, step);
  EXPECT_GE(distance, wall);
  EXPECT_GE(distance, cavity.wall);
  EXPECT_GE(cavity.wall, wall);
  EXPECT_LT(distance, wall + voxel * voxel / wall);
  Progress progress;
  EXPECT_EQ(whatIsBroken(meshes::joined({solid, cavity.surface}), progress), "");
}

TEST(Cavity, OfABallIsABall) {
  const TriangleMesh ball = meshes::sphere({1, 2, 3}, 10, 40);
  const Cavity cavity = cavityOf(ball, 2, 0.1);
  const double analytic = 4.0 / 3 * kPi * (1000 - 512);
  const double hollow = meshes::signedVolume(ball) + meshes::signedVolume(cavity.surface);
  // The faces of the ball lie within it: what they cut off is not the cavity's doing.
  const double cut = 4.0 / 3 * kPi * 1000 - meshes::signedVolume(ball);
  EXPECT_LT(cut, 2e-3 * analytic);
  EXPECT_NEAR(hollow, analytic, 1e-3 * analytic + cut);
  EXPECT_TRUE(oracles::isClosedManifold(cavity.surface));
  for (const Vec3d& p : cavity.surface.points)
    EXPECT_NEAR(std::hypot(p[0] - 1, p[1] - 2, p[2] - 3), 8, 0.03);
}

TEST(Cavity, NoWallIsThinner) {
  const TriangleMesh ball = meshes::sphere({0.3, -0.2, 0.1}, 10, 12);
  expectWall(ball, cavityOf(ball, 2, 0.25), 2, 0.25, 5);
  const TriangleMesh box = meshes::box({-7, -5, 0.03}, {9, 6.1, 8}, 1);
  expectWall(box, cavityOf(box, 1.5, 0.2), 1.5, 0.2);
  const TriangleMesh ring = meshes::torus(10, 4, 48, 24);
  expectWall(ring, cavityOf(ring, 1, 0.2), 1, 0.2, 7);
}

// The distance of triangles, by brute force, to all of the solid's: what is proven of the cavity as
// it is made holds for fewer faces.
TEST(Cavity, NoWallGetsThinnerWhereFacesAreMerged) {
  for (const TriangleMesh& solid :
       {meshes::sphere({0.3, -0.2, 0.1}, 10, 12), meshes::box({-7, -5, 0.03}, {9, 6.1, 8}, 1),
        meshes::torus(10, 4, 48, 24)}) {
    const double wall = 1.5, voxel = 0.2;
    Cavity cavity = cavityOf(solid, wall, voxel);
    const std::size_t faces = cavity.surface.triangleCount();
    const double volume = meshes::signedVolume(cavity.surface);
    double area = 0;
    for (std::size_t i = 0; i < cavity.surface.triangles.size(); i += 3) {
      const auto at = [&](std::size_t k) {
        return cavity.surface.points[cavity.surface.triangles[i + k]];
      };
      const Vec3d normal = cross(minus(at(1), at(0)), minus(at(2), at(0)));
      area += length(normal) / 2;
    }
    SimplifyOptions options;
    options.tolerance = 0.25 * voxel;
    options.outward = true;
    Progress progress;
    simplifySurface(cavity.surface, options, progress);
    EXPECT_LT(cavity.surface.triangleCount(), faces / 4);
    EXPECT_TRUE(oracles::isClosedManifold(cavity.surface));
    EXPECT_GE(oracles::distanceBetween(asFloats(cavity.surface), solid), cavity.wall);
    EXPECT_EQ(whatIsBroken(meshes::joined({solid, cavity.surface}), progress), "");
    const double thicker = (meshes::signedVolume(cavity.surface) - volume) / area; // both below 0
    EXPECT_GE(thicker, 0);
    EXPECT_LT(thicker, options.tolerance);
  }
}

TEST(Cavity, OfABoxIsABoxWithoutItsCorners) {
  const TriangleMesh box = meshes::box({0, 0, 0}, {10, 12, 14});
  const double voxel = 0.1;
  const double inner = -meshes::signedVolume(cavityOf(box, 2, voxel).surface);
  EXPECT_LT(inner, 6 * 8 * 10);
  // Off by the guard, 3/8 voxel^2 / wall, over the faces, and by less than half a square voxel
  // along the edges.
  const double guard = 3.0 / 8 * voxel * voxel / 2 * 1.1;
  EXPECT_GT(inner, 6 * 8 * 10 - 2 * (6 * 8 + 8 * 10 + 10 * 6) * guard -
                       4 * (6 + 8 + 10) * voxel * voxel / 2);
}

TEST(Cavity, IsNoneWhereWallsMeet) {
  EXPECT_TRUE(cavityOf(meshes::box({0, 0, 0}, {30, 20, 3.9}), 2, 0.2).surface.triangles.empty());
  // Two blocks joined by a thin plate have two cavities.
  const TriangleMesh plate = meshes::box({0, 0, 0}, {30, 10, 3}, 30);
  const auto thick = [](const Vec3d& p) {
    const bool inBlock = p[0] < 10.5 || p[0] > 19.5;
    return Vec3d{p[0], p[1], inBlock ? p[2] / 3 * 10 : p[2]};
  };
  const TriangleMesh dumbbell = meshes::moved(plate, thick);
  const Cavity cavity = cavityOf(dumbbell, 2, 0.25);
  double lowest = 30, highest = 0;
  // Two units off the edges where the plate begins, at (11, 3) and (19, 3), and off its floor.
  const double reach = std::sqrt(2 * 2 - 1 * 1);
  for (const Vec3d& p : cavity.surface.points) {
    EXPECT_TRUE(p[0] <= 11 - reach || p[0] >= 19 + reach) << p[0];
    lowest = std::min(lowest, p[0]);
    highest = std::max(highest, p[0]);
  }
  EXPECT_LT(lowest, 3);
  EXPECT_GT(highest, 27);
}

TEST(Cavity, KeepsOffCavitiesThatAreThere) {
  const TriangleMesh solid =
      meshes::joined({meshes::box({0, 0, 0}, {20, 20, 20}, 4),
                      meshes::flipped(meshes::sphere({11, 10, 9.5}, 3, 8)),
                      meshes::sphere({40, 10, 10}, 8, 10)}); // and a second component
  const Cavity cavity = cavityOf(solid, 1.5, 0.2);
  expectWall(solid, cavity, 1.5, 0.2, 11);
  const double ball = 4.0 / 3 * kPi;
  const double analytic = 17 * 17 * 17 - ball * 4.5 * 4.5 * 4.5 + ball * 6.5 * 6.5 * 6.5;
  EXPECT_NEAR(-meshes::signedVolume(cavity.surface), analytic, 0.02 * analytic);
}

TEST(Cavity, IsNowhereNarrowWhereItIsClosed) {
  // A bar of 6 with a block of 16 at its end: by walls of 2 the bar's cavity is 2 wide.
  const TriangleMesh bar =
      meshes::moved(meshes::box({0, 0, 0}, {36, 6, 6}, 36), [](const Vec3d& p) {
        return p[0] < 20.5 ? p
                           : Vec3d{p[0],
                                   p[1] > 5.9   ? 11
                                   : p[1] < 0.1 ? -5
                                                : p[1],
                                   p[2] > 5.9   ? 11
                                   : p[2] < 0.1 ? -5
                                                : p[2]};
      });
  const double open = -meshes::signedVolume(cavityOf(bar, 2, 0.2).surface);
  const Cavity closed = cavityOf(bar, 2, 0.2, 1.5);
  expectWall(bar, closed, 2, 0.2, 3);
  double lowest = 36;
  for (const Vec3d& p : closed.surface.points)
    lowest = std::min(lowest, p[0]);
  EXPECT_GT(lowest, 19); // the bar's is gone
  EXPECT_LT(-meshes::signedVolume(closed.surface), open - 2 * 2 * 15);
  // A ball of the radius in every place: corners of the block's cavity are round.
  const double side = 11.9;
  EXPECT_LT(-meshes::signedVolume(closed.surface), side * 12 * 12);
  EXPECT_GT(-meshes::signedVolume(closed.surface), 0.9 * side * 12 * 12);
}

TEST(Cavity, IsTheSameForAnyNumberOfThreads) {
  const TriangleMesh ring = meshes::torus(10, 4, 48, 24);
  const Cavity one = cavityOf(ring, 1, 0.25, 0.6, 1), four = cavityOf(ring, 1, 0.25, 0.6, 4);
  EXPECT_EQ(one.surface.points, four.surface.points);
  EXPECT_EQ(one.surface.triangles, four.surface.triangles);
  EXPECT_EQ(one.wall, four.wall);
}

TEST(Cavity, RefusesWhatItCannotPromise) {
  const TriangleMesh box = meshes::box({0, 0, 0}, {10, 10, 10});
  const auto statusOf = [&](double wall, double voxel, double close, std::size_t memory) {
    CavityOptions options;
    options.wall = wall;
    options.voxel = voxel;
    options.close = close;
    options.maxMemory = memory;
    Report report;
    Progress progress;
    try {
      makeCavity(box, options, report, progress);
    } catch (const Error& error) {
      return error.status();
    }
    return Status::Ok;
  };
  EXPECT_EQ(statusOf(1, 0.6, 0, 0), Status::Usage);
  EXPECT_EQ(statusOf(1, 0.2, 0.3, 0), Status::Usage);
  EXPECT_EQ(statusOf(1, 0, 0, 0), Status::Usage);
  EXPECT_EQ(statusOf(1, 0.001, 0, std::size_t(1) << 30), Status::Limit);
  EXPECT_EQ(statusOf(1, 0.25, 0, 0), Status::Ok);
}

} // namespace
} // namespace tetvdb
