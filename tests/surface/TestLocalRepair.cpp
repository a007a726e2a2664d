// SPDX-License-Identifier: Apache-2.0
#include "ManifoldCheck.h"
#include "TriangleMeshes.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/LocalRepair.h"
#include "tetvdb/surface/MeshChanges.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

LocalRepair repaired(TriangleMesh& mesh) {
  Progress progress;
  cleanTriangles(mesh, {}, progress);
  LocalRepair repair = repairLocally(mesh, progress);
  EXPECT_EQ(repair.succeeded, repair.why.empty());
  if (repair.succeeded) {
    EXPECT_EQ(manifoldDefect(mesh), "");
    EXPECT_EQ(whatIsBroken(mesh, progress), "");
  }
  return repair;
}

TEST(LocalRepair, WhatIsBrokenIsNamed) {
  Progress progress;
  EXPECT_EQ(whatIsBroken(box(), progress), "");
  EXPECT_EQ(whatIsBroken(without(box(), [](std::size_t f) { return f == 0; }), progress),
            "3 boundary edges");
  EXPECT_EQ(whatIsBroken(flipped(box()), progress), "no volume");
  EXPECT_EQ(whatIsBroken(joined({box(), box({0.5, 0.2, 0.3}, {2, 0.7, 0.8})}), progress)
                    .find("pairs of faces that cross") == std::string::npos,
            false);
}

TEST(LocalRepair, HolesAlone) {
  const TriangleMesh whole = torus(1, 0.4, 60, 30);
  TriangleMesh mesh = without(whole, [](std::size_t f) { return f % 301 < 3; });
  const TriangleMesh torn = mesh;
  const LocalRepair repair = repaired(mesh);
  ASSERT_TRUE(repair.succeeded) << repair.why;
  EXPECT_EQ(repair.holes.size(), 12u);
  const MeshChanges changes = meshChanges(torn, mesh);
  EXPECT_EQ(changes.kept, torn.triangleCount());
  EXPECT_EQ(changes.removed, 0u);
  EXPECT_EQ(mesh.triangleCount(), whole.triangleCount());
  EXPECT_NEAR(signedVolume(mesh), signedVolume(whole), 1e-3 * signedVolume(whole));
}

TEST(LocalRepair, SheetsGoAndSolidsStay) {
  TriangleMesh mesh = joined({box({0, 0, 0}, {1, 1, 1}, 3), sheet(4, 2)});
  const LocalRepair repair = repaired(mesh);
  ASSERT_TRUE(repair.succeeded) << repair.why;
  EXPECT_EQ(repair.sheets.parts, 1u);
  EXPECT_EQ(repair.sheets.faces, 32u);
  EXPECT_EQ(mesh.triangleCount(), 108u);
  TriangleMesh alone = sheet(4);
  EXPECT_EQ(repaired(alone).why, "only sheets");
  EXPECT_EQ(alone.triangleCount(), 32u);
}

TEST(LocalRepair, FacesWithoutAreaThatCloseNothingGo) {
  const TriangleMesh whole = box({0, 0, 0}, {1, 1, 1}, 2);
  TriangleMesh mesh = whole;
  for (std::size_t face = 0; face < whole.triangleCount(); face += 5) {
    const std::uint32_t a = whole.triangles[3 * face], b = whole.triangles[3 * face + 1];
    const auto midpoint = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.push_back(times(plus(whole.points[a], whole.points[b]), 0.5));
    mesh.triangles.insert(mesh.triangles.end(), {a, midpoint, b});
  }
  mesh.faceCount = mesh.triangleCount();
  const LocalRepair repair = repaired(mesh);
  ASSERT_TRUE(repair.succeeded) << repair.why;
  const MeshChanges changes = meshChanges(whole, mesh);
  EXPECT_EQ(changes.kept, whole.triangleCount());
  EXPECT_EQ(mesh.triangleCount(), whole.triangleCount());
}

TEST(LocalRepair, AnOpenBoxIsASolid) {
  TriangleMesh mesh = without(box({0, 0, 0}, {1, 1, 1}, 2), [](std::size_t f) { return f >= 40; });
  const LocalRepair repair = repaired(mesh);
  ASSERT_TRUE(repair.succeeded) << repair.why;
  EXPECT_EQ(repair.sheets.parts, 0u);
  EXPECT_NEAR(signedVolume(mesh), 1, 1e-14);
}

// Where the winding number closes a hole that is not plane, the solid is smaller than the box.
TEST(LocalRepair, FilledHolesMayAddVolume) {
  const auto withoutSides = [](std::size_t first) { // of those at x = 1, y = 1, z = 1
    return without(box(), [=](std::size_t face) { return face >= first && face % 4 >= 2; });
  };
  TriangleMesh mesh = withoutSides(4); // two of them
  const TriangleMesh open = mesh;
  const LocalRepair repair = repaired(mesh);
  ASSERT_TRUE(repair.succeeded) << repair.why;
  EXPECT_TRUE(repair.closingChangesVolume);
  EXPECT_TRUE(repair.changesVolume);
  EXPECT_GT(repair.solids.gained, 0.01 * repair.solids.before);
  EXPECT_NEAR(signedVolume(mesh), 1, 1e-14);
  EXPECT_EQ(meshChanges(open, mesh).kept, open.triangleCount());
  TriangleMesh corner = withoutSides(0); // all three: a third of the solid would be added
  EXPECT_EQ(repaired(corner).why, "closing it would change its volume");
}

// The smooth patch of a ball's large hole is the rest of the ball, which the winding number does
// not close so.
TEST(LocalRepair, LargeHolesAreFilledWhereTheirEdgesAre) {
  for (const double height : {0.0, 0.3, 0.5}) {
    TriangleMesh mesh = withoutCap(sphere({0, 0, 0}, 1, 24), {0.36, 0.48, 0.8}, height);
    dropUnusedPoints(mesh);
    const double cap = kPi * (1 - height) * (1 - height) * (2 + height) / 3;
    const TriangleMesh open = mesh;
    Progress progress;
    TriangleMesh smooth = open;
    fillHoles(smooth, progress);
    EXPECT_GT(signedVolume(smooth), 1.1 * (4 * kPi / 3 - cap));
    const LocalRepair repair = repaired(mesh);
    ASSERT_TRUE(repair.succeeded) << repair.why;
    EXPECT_FALSE(repair.closingChangesVolume);
    EXPECT_EQ(meshChanges(open, mesh).kept, open.triangleCount());
    EXPECT_NEAR(signedVolume(mesh), 4 * kPi / 3 - cap, 0.1) << height; // half of a face
  }
}

TEST(LocalRepair, SolidsThatTouchMoveApart) {
  // At an edge, at a point, and two wedges of one solid at an edge.
  for (const TriangleMesh& given :
       {joined({box({0, 0, 0}, {1, 1, 1}, 2), box({1, 1, 0}, {2, 2, 1}, 2)}),
        joined({box({0, 0, 0}, {1, 1, 1}, 2), box({1, 1, 1}, {2, 2, 2}, 2)})}) {
    TriangleMesh mesh = given;
    const double volume = signedVolume(mesh);
    const LocalRepair repair = repaired(mesh);
    ASSERT_TRUE(repair.succeeded) << repair.why;
    EXPECT_GT(repair.separatedPoints, 0u);
    EXPECT_LT(repair.largestMove, 1e-5);
    EXPECT_NEAR(signedVolume(mesh), volume, 1e-5);
    EXPECT_GT(meshChanges(given, mesh).kept, given.triangleCount() / 2);
  }
}

TEST(LocalRepair, SolidsWhoseEdgesTouchAtAPointMoveApart) {
  // Bores of a part whose walls touch: an edge along z and one along y, at x = 0.
  TriangleMesh left = box({0, 0, 0}, {1, 1, 1}), right = left;
  for (Vec3d& p : left.points)
    p = {-p[0] - p[1], p[0] - p[1], 4 * p[2] - 1.5};
  for (Vec3d& p : right.points)
    p = {p[0] + p[1], 4 * p[2] - 1.5, p[0] - p[1]};
  for (TriangleMesh* one : {&left, &right})
    if (signedVolume(*one) < 0)
      *one = flipped(*one);
  TriangleMesh mesh = joined({left, right});
  const LocalRepair repair = repaired(mesh);
  EXPECT_TRUE(repair.succeeded) << repair.why;
  EXPECT_EQ(repair.crossings.cutFaces, 4u);
  EXPECT_EQ(repair.separatedPoints, 1u);
  EXPECT_LT(repair.largestMove, 1e-3);
}

TEST(LocalRepair, EqualAsFloatsBecomeOne) {
  TriangleMesh mesh = unwelded(sphere({3, 4, 5}, 1, 6));
  Random random(9);
  for (Vec3d& p : mesh.points)
    for (double& c : p)
      c = double(float(c)) * (1 + 1e-12 * random.unit());
  const std::size_t faces = mesh.triangleCount();
  const LocalRepair repair = repaired(mesh);
  ASSERT_TRUE(repair.succeeded) << repair.why;
  EXPECT_EQ(mesh.triangleCount(), faces);
}

TEST(LocalRepair, OfADoubledSurfaceOneStaysBitForBit) {
  // A ball and its double, moved by less than rounding to floats makes of it, or a little more.
  const TriangleMesh ball = sphere({3, 4, 5}, 1, 12);
  for (const double noise : {1e-7, 1e-5}) {
    Random random(23);
    TriangleMesh other = ball;
    for (Vec3d& p : other.points)
      for (double& c : p)
        c += noise * (2 * random.unit() - 1);
    TriangleMesh mesh = joined({ball, other});
    const LocalRepair repair = repaired(mesh);
    ASSERT_TRUE(repair.succeeded) << repair.why;
    EXPECT_EQ(repair.doubleFaces, ball.triangleCount());
    EXPECT_EQ(mesh.triangleCount(), ball.triangleCount());
    const std::size_t kept = std::max(meshChanges(ball, mesh).kept, meshChanges(other, mesh).kept);
    EXPECT_EQ(kept, ball.triangleCount());
  }
}

TEST(LocalRepair, FlatFacesInEdgesGo) {
  // T-junctions closed by faces whose middle corner is off the edge by rounding alone.
  TriangleMesh mesh = sphere({0.1, 0.2, 0.3}, 1, 8);
  const std::size_t faces = mesh.triangleCount();
  const double volume = signedVolume(mesh);
  for (std::uint32_t face = 0; face < faces; face += 7) {
    const std::uint32_t a = mesh.triangles[3 * face], b = mesh.triangles[3 * face + 1],
                        c = mesh.triangles[3 * face + 2];
    const auto midpoint = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.push_back(times(plus(mesh.points[a], mesh.points[b]), 0.5));
    mesh.triangles[3 * face + 1] = midpoint;
    for (const std::uint32_t v : {midpoint, b, c, a, b, midpoint})
      mesh.triangles.push_back(v);
  }
  mesh.faceCount = mesh.triangleCount();
  const TriangleMesh before = mesh;
  Progress progress;
  ASSERT_NE(whatIsBroken(mesh, progress), "");
  const LocalRepair repair = repairLocally(mesh, progress);
  ASSERT_TRUE(repair.succeeded) << repair.why;
  EXPECT_EQ(manifoldDefect(mesh), "");
  EXPECT_NEAR(signedVolume(mesh), volume, 1e-14);
  // Of each, the flat face and its neighbour become two others.
  const std::size_t flat = (faces + 6) / 7;
  EXPECT_EQ(meshChanges(before, mesh).removed, 2 * flat);
  EXPECT_EQ(meshChanges(before, mesh).added, 2 * flat);
}

// Boxes whose corners are on a grid, turned by less than 32-bit floats resolve well: faces meet at
// angles of millionths.
TriangleMesh almostAlignedBoxes(Random& random) {
  const auto below = [&](std::size_t n) { return static_cast<double>(random.below(n)); };
  TriangleMesh all;
  for (std::size_t count = random.below(9) + 3; count > 0; --count) {
    Vec3d size;
    for (double& s : size)
      s = (below(5) + 1) * 0.37;
    TriangleMesh one = box({-0.2, -0.2, -0.2}, minus(size, {0.2, 0.2, 0.2}));
    const double angle = below(1000) * 1e-8;
    const std::size_t axis = random.below(3);
    Vec3d offset{100, 50, -30};
    for (double& o : offset)
      o += (below(7) - 3) * 0.185;
    for (Vec3d& p : one.points) {
      const double a = p[(axis + 1) % 3], b = p[(axis + 2) % 3];
      p[(axis + 1) % 3] = a - angle * b;
      p[(axis + 2) % 3] = b + angle * a;
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = static_cast<float>(p[k] + offset[k]);
    }
    all = joined({all, one});
  }
  return all;
}

TEST(LocalRepair, WhatSeparatedPointsMakeCrossIsCutAgain) {
  // Those of the first 600 that need it.
  for (const std::uint64_t seed : {19u, 120u, 159u, 178u, 340u, 535u}) {
    Random random(seed);
    TriangleMesh mesh = almostAlignedBoxes(random);
    const LocalRepair repair = repaired(mesh);
    EXPECT_TRUE(repair.succeeded) << seed << ": " << repair.why;
  }
}

// With coordinates that are not 32-bit floats.
TEST(LocalRepair, CoordinatesAreRoundedWhereCuttingNeedsIt) {
  std::size_t rounded = 0;
  for (const std::uint64_t seed : {61u, 98u, 217u, 308u, 340u, 555u}) {
    Random random(seed);
    TriangleMesh mesh = almostAlignedBoxes(random);
    for (Vec3d& p : mesh.points)
      p = times(p, 1.0 / 3);
    const LocalRepair repair = repaired(mesh);
    EXPECT_TRUE(repair.succeeded) << seed << ": " << repair.why;
    rounded += repair.roundsToFloats;
  }
  EXPECT_EQ(rounded, 1u); // 308
}

/// A solid over a star whose top is a fan in the plane z = 0.4749 - 3e-9 (x + y), as far as floats
/// hold it.
TriangleMesh starPrism(const Vec3d& centre, double radius, std::uint32_t corners, Random& random) {
  TriangleMesh mesh;
  const auto add = [&](double x, double y, double z) {
    mesh.points.push_back({double(float(x)), double(float(y)), double(float(z))});
  };
  for (std::uint32_t i = 0; i < corners; ++i) {
    const double angle = 2 * kPi * i / corners, r = radius * random.between(0.6, 1);
    add(centre[0] + r * std::cos(angle), centre[1] + r * std::sin(angle), -1);
  }
  add(centre[0], centre[1], -1);
  const std::uint32_t top = corners + 1;
  for (std::uint32_t i = 0; i < top; ++i) {
    const Vec3d p = mesh.points[i];
    add(p[0], p[1], 0.4749 - 3e-9 * (p[0] + p[1]));
  }
  for (std::uint32_t i = 0; i < corners; ++i) {
    const std::uint32_t j = (i + 1) % corners;
    for (const std::uint32_t v :
         {corners, j, i, corners + top, i + top, j + top, i, j, j + top, i, j + top, i + top})
      mesh.triangles.push_back(v);
  }
  mesh.faceCount = mesh.triangleCount();
  return mesh;
}

TEST(LocalRepair, NearlyCoplanarFacesThatOverlapAreAligned) {
  Random random(22);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 8; ++i) {
    const double x = random.between(-150, 150), y = random.between(-150, 150);
    const double radius = random.between(150, 330);
    mesh = joined({mesh, starPrism({x, y, 0}, radius, 20 + 4 * i, random)});
  }
  const LocalRepair repair = repaired(mesh);
  EXPECT_TRUE(repair.succeeded) << repair.why;
  EXPECT_GT(repair.alignedPoints, 100u);
  EXPECT_LT(repair.largestMove, 2e-3); // a lattice of 2^-10 to 2^-9; the diagonal is some 1300
  EXPECT_FALSE(repair.changesVolume);
}

// A box with a tunnel from one vertical edge to the opposite one, whose roof ridge is a diagonal of
// the lid. The lid is folded along the other diagonal, and by less than the unit of the lattice too
// low there, so that the ridge sticks out of it. On the lattice it does not.
TEST(LocalRepair, FacesThatCrossByLessThanTheLattice) {
  TriangleMesh mesh;
  const double step = 0x1p-45; // a 64th of the unit
  mesh.points = {{0, 0, 29 * step}, {1, 0, 33 * step}, {1, 1, 29 * step}, {0, 1, 19 * step},
                 {0, 0, -1},        {1, 0, -1},        {1, 1, -1},        {0, 1, -1},
                 {0, 0, -0.25},     {0.25, 0, -0.25},  {0, 0.25, -0.25},  {1, 1, -0.25},
                 {1, 0.75, -0.25},  {0.75, 1, -0.25}};
  for (const std::array<std::uint32_t, 3>& f : std::vector<std::array<std::uint32_t, 3>>{
           {0, 1, 3},  {1, 2, 3},   {4, 7, 6},   {4, 6, 5},    // lid, bottom
           {5, 1, 9},  {1, 0, 9},   {4, 5, 9},   {4, 9, 8},    // front
           {5, 6, 12}, {6, 11, 12}, {5, 12, 1},  {12, 2, 1},   // right
           {7, 3, 13}, {3, 2, 13},  {6, 7, 13},  {6, 13, 11},  // back
           {7, 4, 10}, {4, 8, 10},  {7, 10, 3},  {10, 0, 3},   // left
           {0, 2, 12}, {0, 12, 9},  {0, 10, 13}, {0, 13, 2},   // roof of the tunnel
           {8, 9, 12}, {8, 12, 11}, {8, 11, 13}, {8, 13, 10}}) // its floor
    addTriangle(mesh, f[0], f[1], f[2]);
  Progress progress;
  EXPECT_EQ(whatIsBroken(mesh, progress), "4 pairs of faces that cross");
  const LocalRepair repair = repaired(mesh);
  ASSERT_TRUE(repair.succeeded) << repair.why;
  EXPECT_EQ(mesh.triangleCount(), 28u);
  EXPECT_LT(repair.largestMove, 0x1p-39);
  EXPECT_GT(repair.alignedPoints, 0u);
}

TEST(LocalRepair, WhatFailsIsLeftAsItWas) {
  TriangleMesh mesh = moebius();
  Progress progress;
  cleanTriangles(mesh, {}, progress);
  const TriangleMesh before = mesh;
  const LocalRepair repair = repairLocally(mesh, progress);
  EXPECT_FALSE(repair.succeeded);
  EXPECT_FALSE(repair.why.empty());
  EXPECT_EQ(mesh.triangles, before.triangles);
  EXPECT_EQ(mesh.points, before.points);
}

} // namespace
} // namespace tetvdb
