// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <limits>

namespace tetvdb {
namespace {

Voxelization run(const TriangleMesh& mesh, double shell, ShellSide side, double size) {
  SolidOptions solid;
  solid.shell = shell;
  solid.side = side;
  VoxelizeOptions options;
  options.voxelSize = {size, size, size};
  options.grids = {GridKind::Mask};
  options.allowEmpty = true;
  Report report;
  Progress progress;
  return voxelize(mesh, solid, options, report, progress);
}

const openvdb::BoolGrid& maskOf(const Voxelization& made) {
  return *openvdb::gridConstPtrCast<openvdb::BoolGrid>(made.volume.grids().all.front());
}

double toSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d ab = minus(b, a);
  const double t = std::clamp(dot(minus(p, a), ab) / dot(ab, ab), 0.0, 1.0);
  return length(minus(p, plus(a, times(ab, t))));
}

// To the plane where the foot lies within the triangle, else to the nearest side.
double toTriangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d n = cross(minus(b, a), minus(c, a));
  const double height = dot(n, minus(p, a)) / length(n);
  const Vec3d foot = minus(p, times(n, height / length(n)));
  const auto within = [&](const Vec3d& u, const Vec3d& v) {
    return dot(cross(minus(v, u), minus(foot, u)), n) >= 0;
  };
  if (within(a, b) && within(b, c) && within(c, a))
    return std::abs(height);
  return std::min({toSegment(p, a, b), toSegment(p, b, c), toSegment(p, c, a)});
}

double distanceTo(const TriangleMesh& mesh, const Vec3d& p) {
  double min = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < mesh.triangleCount(); ++f)
    min = std::min(min, toTriangle(p, mesh.points[mesh.triangles[3 * f]],
                                   mesh.points[mesh.triangles[3 * f + 1]],
                                   mesh.points[mesh.triangles[3 * f + 2]]));
  return min;
}

// Whether a point is outside, where `known`.
using Outside = std::function<bool(const Vec3d& p, bool& known)>;

void expectSides(const TriangleMesh& mesh, double shell, double size, int low, int high,
                 const Outside& outside) {
  const Voxelization outwardMade = run(mesh, shell, ShellSide::Outward, size);
  const Voxelization inwardMade = run(mesh, shell, ShellSide::Inward, size);
  const auto outward = maskOf(outwardMade).getConstAccessor();
  const auto inward = maskOf(inwardMade).getConstAccessor();
  std::uint64_t found[2] = {0, 0}, wrong = 0, all[2] = {0, 0};
  for (int x = low; x <= high; ++x)
    for (int y = low; y <= high; ++y)
      for (int z = low; z <= high; ++z) {
        const Vec3d p{x * size, y * size, z * size};
        const openvdb::Coord at(x, y, z);
        all[0] += outward.isValueOn(at);
        all[1] += inward.isValueOn(at);
        const double d = distanceTo(mesh, p);
        if (std::abs(d - shell) < 1e-5 * size)
          continue;
        bool known = true;
        const bool out = outside(p, known);
        if (!known) {
          wrong += (outward.isValueOn(at) + inward.isValueOn(at)) != (d < shell);
          continue;
        }
        found[out ? 0 : 1] += d < shell;
        if ((outward.isValueOn(at) != (out && d < shell) ||
             inward.isValueOn(at) != (!out && d < shell)) &&
            ++wrong < 5)
          ADD_FAILURE() << x << ' ' << y << ' ' << z << " outside " << out << " distance " << d;
      }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(found[0], 100u);
  EXPECT_GT(found[1], 100u);
  EXPECT_EQ(maskOf(outwardMade).activeVoxelCount(), all[0]) << "voxels far away";
  EXPECT_EQ(maskOf(inwardMade).activeVoxelCount(), all[1]);
}

TEST(ShellSide, ClosedMeshes) {
  const TriangleMesh crossing =
      meshes::moved(meshes::joined({meshes::sphere({0, 0, 0}, 1, 5),
                                    meshes::box({0.3, 0.2, 0.1}, {1.2, 1.3, 1.1})}),
                    [](const Vec3d& p) {
                      return Vec3d{p[0] + 0.0123, p[1] - 0.0321, p[2] + 0.00417};
                    });
  expectSides(crossing, 0.2, 0.07, -20, 25,
              [&](const Vec3d& p, bool&) { return meshes::windingNumberAt(crossing, p) < 0.5; });
}

// Faces through voxel centres: of two opposite ones the solid has the centres of one.
TEST(ShellSide, CubeOnTheLattice) {
  const TriangleMesh cube = meshes::box({0, 0, 0}, {10, 10, 10});
  EXPECT_EQ(maskOf(run(cube, 2, ShellSide::Inward, 1)).activeVoxelCount(), 1000u - 125u);
  std::uint64_t outside = 0;
  for (int x = -4; x < 16; ++x)
    for (int y = -4; y < 16; ++y)
      for (int z = -4; z < 16; ++z) {
        int squares = 0, in = 0;
        for (const int c : {x, y, z}) {
          const int away = std::max({0, -c, c - 10});
          squares += away * away;
          in += c >= 0 && c < 10;
        }
        outside += in < 3 && squares <= 4;
      }
  EXPECT_EQ(maskOf(run(cube, 2, ShellSide::Outward, 1)).activeVoxelCount(), outside);
}

TEST(ShellSide, SheetOnTheLattice) {
  const TriangleMesh sheet = meshes::moved(meshes::sheet(3), [](const Vec3d& p) {
    return Vec3d{12 * p[0], 12 * p[1], p[2] + 3};
  });
  expectSides(sheet, 2.5, 1, -6, 18, [](const Vec3d& p, bool&) { return p[2] >= 3; });
  expectSides(meshes::flipped(sheet), 2.5, 1, -6, 18,
              [](const Vec3d& p, bool&) { return p[2] < 3; });
  // Lying along other axes.
  const TriangleMesh wall = meshes::moved(meshes::sheet(3), [](const Vec3d& p) {
    return Vec3d{p[2] + 3, 12 * p[0], 12 * p[1]};
  });
  expectSides(wall, 2.5, 1, -6, 18, [](const Vec3d& p, bool&) { return p[0] >= 3; });
}

// A pyramid without a floor: near its edges and its tip the nearest face alone does not tell.
TEST(ShellSide, EdgesAndTips) {
  TriangleMesh roof;
  roof.points = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, 2.5}};
  for (std::uint32_t k = 0; k < 4; ++k)
    meshes::addTriangle(roof, k, (k + 1) % 4, 4);
  for (Vec3d& p : roof.points)
    p = {p[0] + 0.0113, p[1] + 0.0071, p[2] + 0.0017};
  const auto above = [](const Vec3d& p, bool& known) {
    const double out = std::max(std::abs(p[0] - 0.0113), std::abs(p[1] - 0.0071));
    known = p[2] > 0.5; // away from the border
    return p[2] - 0.0017 > 2.5 * (1 - out);
  };
  expectSides(roof, 0.3, 0.06, -24, 50, above);
}

TEST(ShellSide, IndependentOfTheOrderOfFaces) {
  const TriangleMesh open = meshes::without(meshes::sphere({0.01, 0.02, 0.03}, 1, 8),
                                            [](std::size_t f) { return f % 7 == 0; });
  for (const ShellSide side : {ShellSide::Outward, ShellSide::Inward})
    EXPECT_EQ(hash(run(open, 0.2, side, 0.05).volume),
              hash(run(meshes::shuffledFaces(open), 0.2, side, 0.05).volume));
}

TEST(ShellSide, ResolutionCountsWhatItReaches) {
  for (const ShellSide side : {ShellSide::Both, ShellSide::Outward, ShellSide::Inward}) {
    SolidOptions solid;
    solid.shell = 0.25;
    solid.side = side;
    VoxelizeOptions options;
    options.resolution = 40;
    Report report;
    Progress progress;
    const GridInfo grid =
        describe(voxelize(meshes::box(), solid, options, report, progress).volume).front();
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LE(grid.boxMax[k] - grid.boxMin[k] + 1, 40);
      EXPECT_GE(grid.boxMax[k] - grid.boxMin[k] + 1, 39);
    }
  }
}

TEST(ShellSide, NotByFlood) {
  SolidOptions solid;
  solid.shell = 0.1;
  solid.side = ShellSide::Inward;
  solid.inside = InsideRule::Flood;
  Report report;
  Progress progress;
  EXPECT_THROW(voxelize(meshes::box(), solid, {}, report, progress), Error);
}

} // namespace
} // namespace tetvdb
