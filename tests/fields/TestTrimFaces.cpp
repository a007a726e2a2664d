// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "fields/UnionBoundary.h"
#include "tetvdb/fields/DistanceBand.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/fields/TrimFaces.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/voxelize/SoupChain.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

struct Surface {
  openvdb::FloatGrid::Ptr grid;
  openvdb::BoolGrid::Ptr mask;
  TrimCounts counts;
  Report report;
};

template <typename... Input>
Surface surfaceOf(double voxel, double halfWidth, const Input&... input) {
  VoxelizeOptions options;
  options.voxelSize = {voxel, voxel, voxel};
  options.grids = {GridKind::Mask};
  ShapeOptions shapes;
  shapes.grids = {ShapeGrid::Surface};
  shapes.halfWidth = halfWidth;
  Surface surface;
  Progress progress;
  Voxelization made = voxelize(input..., options, surface.report, progress);
  surface.counts = addShapeGrids(input..., shapes, made, surface.report, progress).trim;
  surface.mask = openvdb::gridPtrCast<openvdb::BoolGrid>(made.volume.grids().all.front());
  surface.grid = openvdb::gridPtrCast<openvdb::FloatGrid>(made.volume.grids().all.back());
  return surface;
}

// All voxels of the band, and two around it: magnitudes are `distance`, up to `tolerance` voxels.
void expectMagnitudes(const Surface& surface, double voxel, double tolerance,
                      const std::function<double(const Vec3d&, double)>& distance) {
  const auto values = surface.grid->getConstAccessor();
  const auto inside = surface.mask->getConstAccessor();
  const double band = surface.grid->background();
  openvdb::CoordBBox box = surface.grid->evalActiveVoxelBoundingBox();
  box.expand(2);
  int wrong = 0;
  for (auto at = box.begin(); at; ++at) {
    const Vec3d p{(*at).x() * voxel, (*at).y() * voxel, (*at).z() * voxel};
    const double value = values.getValue(*at), expected = std::min(distance(p, band), band);
    const bool right = (value < 0) == inside.isValueOn(*at) &&
                       std::abs(std::abs(value) - expected) <= tolerance * voxel;
    if (!right && ++wrong < 5)
      ADD_FAILURE() << *at << ": " << value << ", expected " << expected;
  }
  EXPECT_EQ(wrong, 0);
}

constexpr double kTolerance = kDistanceError + 1e-6; // and the floats' own rounding

// Distance to the boundary of bodies' union, up to the second argument.
std::function<double(const Vec3d&, double)> toUnion(const std::vector<oracle::Body>& bodies) {
  return [faces = oracle::PolygonDistance(oracle::boundaryOfUnion(bodies))](const Vec3d& p,
                                                                            double most) {
    return static_cast<double>(faces({p[0], p[1], p[2]}, most));
  };
}

oracle::Point pointOf(const Vec3d& p) {
  return {p[0], p[1], p[2]};
}

std::vector<oracle::Body> bodiesOf(const TetMesh& mesh) {
  std::vector<oracle::Body> bodies;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t)
    bodies.push_back(oracle::tetBody(
        {pointOf(mesh.points[mesh.tets[4 * t]]), pointOf(mesh.points[mesh.tets[4 * t + 1]]),
         pointOf(mesh.points[mesh.tets[4 * t + 2]]), pointOf(mesh.points[mesh.tets[4 * t + 3]])}));
  return bodies;
}

// The box of `low` and `high`, turned by `turn`.
oracle::Body boxBody(const Vec3d& low, const Vec3d& high,
                     const std::function<Vec3d(const Vec3d&)>& turn) {
  const auto corner = [&](int x, int y, int z) {
    return pointOf(turn({x ? high[0] : low[0], y ? high[1] : low[1], z ? high[2] : low[2]}));
  };
  oracle::Body body;
  body.add({corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0), corner(1, 0, 0)});
  body.add({corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1)});
  body.add({corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1)});
  body.add({corner(0, 1, 0), corner(0, 1, 1), corner(1, 1, 1), corner(1, 1, 0)});
  body.add({corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), corner(0, 1, 0)});
  body.add({corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, 0, 1)});
  return body;
}

Vec3d turned(const Vec3d& p) {
  const double c = std::cos(0.37), s = std::sin(0.37);
  const Vec3d q{c * p[0] - s * p[1] + 0.01234, s * p[0] + c * p[1] - 0.04321, p[2] + 0.0031};
  return {q[0], c * q[1] - s * q[2], s * q[1] + c * q[2]};
}
Vec3d turnedOtherwise(const Vec3d& p) {
  const double c = std::cos(1.1), s = std::sin(1.1);
  const Vec3d q{p[0], c * p[1] - s * p[2], s * p[1] + c * p[2]};
  return turned({c * q[0] - s * q[1] + 0.31, s * q[0] + c * q[1] - 0.22, q[2] + 0.17});
}
Vec3d unturned(const Vec3d& p) {
  return p;
}

TEST(TrimFaces, CrossingBoxes) {
  const Vec3d low{0, 0, 0}, high{1, 1, 1}, thin{0.2, 0.3, -0.7}, thinHigh{0.6, 0.5, 1.9};
  TriangleMesh mesh = meshes::joined({meshes::moved(meshes::box(low, high, 3), turned),
                                      meshes::moved(meshes::box(thin, thinHigh, 2), turned),
                                      meshes::moved(meshes::box(low, high), turnedOtherwise)});
  const Surface surface = surfaceOf(0.043, 4, mesh, SolidOptions());
  EXPECT_GT(surface.counts.cut, 10u);
  expectMagnitudes(surface, 0.043, kTolerance,
                   toUnion({boxBody(low, high, turned), boxBody(thin, thinHigh, turned),
                            boxBody(low, high, turnedOtherwise)}));
}

TEST(TrimFaces, BoxesAlongTheAxesWithFacesInOnePlane) {
  // Side faces of both lie in one plane, for which the union's own faces are told by hand.
  const TriangleMesh mesh =
      meshes::joined({meshes::box({0, 0, 0}, {2, 1, 1}), meshes::box({1, 0, 0}, {3, 1, 1}, 2)});
  const Surface surface = surfaceOf(0.0625, 3, mesh, SolidOptions());
  EXPECT_GT(surface.counts.met, 0u);
  expectMagnitudes(surface, 0.0625, kTolerance, toUnion({boxBody({0, 0, 0}, {3, 1, 1}, unturned)}));
}

TEST(TrimFaces, TouchingBoxesOfOtherPoints) {
  const auto whole = toUnion({boxBody({0, 0, 0}, {2, 1, 1}, unturned)});
  for (const int n : {1, 3}) {
    const TriangleMesh mesh =
        meshes::joined({meshes::box({0, 0, 0}, {1, 1, 1}), meshes::box({1, 0, 0}, {2, 1, 1}, n)});
    const Surface surface = surfaceOf(0.07, 3, mesh, SolidOptions());
    EXPECT_EQ(surface.counts.removed, n == 1 ? 4u : 20u); // 2 + 2, or 2 + 18
    EXPECT_EQ(surface.counts.cut, 0u);
    expectMagnitudes(surface, 0.07, kTolerance, whole);
  }
  const TetMesh tets = meshes::joined(meshes::kuhnGrid(1, 1, 1),
                                      meshes::scaled(meshes::kuhnGrid(1, 1, 1), 1, {1, 0, 0}));
  expectMagnitudes(surfaceOf(0.07, 3, tets), 0.07, kTolerance, whole);
}

TEST(TrimFaces, SmallBoxOnALargeOne) {
  const TriangleMesh mesh = meshes::joined(
      {meshes::box({0, 0, 0}, {2, 2, 1}), meshes::box({0.5, 0.6, 1}, {1.1, 1.3, 1.8})});
  const Surface surface = surfaceOf(0.05, 3, mesh, SolidOptions());
  EXPECT_EQ(surface.counts.cut, 2u); // of the large one's upper side
  // What faces have in common with one plane is told apart by a hair.
  expectMagnitudes(surface, 0.05, kTolerance,
                   toUnion({boxBody({0, 0, 0}, {2, 2, 1}, unturned),
                            boxBody({0.5, 0.6, 1 - 1e-9}, {1.1, 1.3, 1.8}, unturned)}));
}

TEST(TrimFaces, NestedSolidsGoAndCavitiesStay) {
  const TriangleMesh outer = meshes::box({0, 0, 0}, {1, 1, 1}, 2);
  const TriangleMesh inner = meshes::box({0.3, 0.3, 0.3}, {0.6, 0.7, 0.7});
  const Surface filled = surfaceOf(0.05, 6, meshes::joined({outer, inner}), SolidOptions());
  EXPECT_EQ(filled.counts.removed, 12u);
  EXPECT_EQ(filled.counts.met, 0u);
  expectMagnitudes(filled, 0.05, kTolerance, toUnion({boxBody({0, 0, 0}, {1, 1, 1}, unturned)}));

  const Surface hollow =
      surfaceOf(0.05, 6, meshes::joined({outer, meshes::flipped(inner)}), SolidOptions());
  EXPECT_EQ(hollow.counts.removed, 0u);
  SolidOptions parity;
  parity.inside = InsideRule::Parity;
  EXPECT_EQ(surfaceOf(0.05, 6, meshes::joined({outer, inner}), parity).counts.removed, 0u);
}

TEST(TrimFaces, RandomTetsAgainstClipping) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const TetMesh tets = meshes::soup(9, 1.0, 1.2, seed);
    const Surface surface = surfaceOf(0.09, 4, tets);
    EXPECT_GT(surface.counts.cut, 0u);
    expectMagnitudes(surface, 0.09, kTolerance, toUnion(bodiesOf(tets)));
  }
}

TEST(TrimFaces, CrossingBalls) {
  const double radius = 1, apart = 1.1;
  const TriangleMesh mesh = meshes::joined(
      {meshes::sphere({0, 0, 0}, radius, 40), meshes::sphere({apart, 0.03, 0.02}, radius, 40)});
  const Surface surface = surfaceOf(0.04, 8, mesh, SolidOptions());
  EXPECT_GT(surface.counts.cut, 100u);
  // Nearest of a sphere's points that are not in the other ball: straight outward, or on the circle
  // in which the spheres meet.
  const double along = std::sqrt(apart * apart + 0.03 * 0.03 + 0.02 * 0.02);
  const Vec3d way{apart / along, 0.03 / along, 0.02 / along};
  const auto distance = [&](const Vec3d& p, double) {
    const double x = p[0] * way[0] + p[1] * way[1] + p[2] * way[2];
    const double r = std::sqrt(std::max(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - x * x, 0.0));
    const auto toSphere = [&](double from) { // centre at 0, the other one at `along`
      const double length = std::hypot(from, r);
      if (from / length * radius <= along / 2)
        return std::abs(length - radius);
      return std::hypot(from - along / 2, r - std::sqrt(radius * radius - along * along / 4));
    };
    return std::min(toSphere(x), toSphere(along - x));
  };
  expectMagnitudes(surface, 0.04, 0.1, distance); // the facets' arrow is 0.06 voxels
}

} // namespace
} // namespace tetvdb
