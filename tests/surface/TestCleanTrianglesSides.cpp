// SPDX-License-Identifier: Apache-2.0
//
// Which way faces look once they are cleaned.
#include "surface/CleanedSolids.h"
#include "tetvdb/core/Error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace tetvdb {
namespace {

using namespace meshes;

// --- Sides of faces.

TEST(CleanTriangles, FlippedFacesTurnBack) {
  for (const TriangleMesh& mesh : {box({0, 0, 0}, {1, 1, 1}, 5), sphere(), torus(), cylinder()})
    for (const double share : {0.05, 0.3, 0.5, 0.9, 1.0}) {
      const TriangleMesh spoiled = withFacesFlipped(mesh, share);
      TriangleMesh result = unwelded(spoiled);
      CleanCounts counts = clean(result);
      for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) // first corners never move
        ASSERT_EQ(result.points[result.triangles[i + 1]], mesh.points[mesh.triangles[i + 1]]);
      std::size_t different = 0;
      for (std::size_t i = 1; i < mesh.triangles.size(); i += 3)
        different += mesh.triangles[i] != spoiled.triangles[i];
      EXPECT_EQ(counts.flippedFaces, different);
    }
}

TEST(CleanTriangles, InsideOutIsSaid) {
  TriangleMesh mesh = flipped(torus());
  const CleanCounts counts = clean(mesh);
  EXPECT_TRUE(counts.insideOut);
  EXPECT_EQ(counts.flippedParts, 1u);
  EXPECT_EQ(counts.flippedFaces, mesh.triangleCount());
  EXPECT_EQ(mesh.triangles, torus().triangles);
  // One part of two is not the whole mesh.
  TriangleMesh two = joined({box({0, 0, 0}, {2, 2, 2}), flipped(box({2.5, 0, 0}, {3, 1, 1}))});
  EXPECT_FALSE(clean(two).insideOut);
}

TEST(CleanTriangles, OrientOffLeavesEveryFace) {
  TriangleMesh mesh = flipped(torus());
  CleanOptions options;
  options.orient = false;
  EXPECT_EQ(clean(mesh, options).flippedFaces, 0u);
  EXPECT_EQ(mesh.triangles, flipped(torus()).triangles);
}

TEST(CleanTriangles, MoebiusStripStays) {
  const TriangleMesh mesh = withFacesFlipped(moebius(), 0.3);
  EXPECT_EQ(cleaned(mesh).triangles, mesh.triangles);
}

TEST(CleanTriangles, OpenPartsThatSurroundSomethingTurn) {
  const auto lid = [](std::size_t face) { return face >= 10; };
  EXPECT_EQ(cleaned(flipped(without(box(), lid))).triangles,
            cleaned(without(box(), lid)).triangles);
  const auto cap = [](std::size_t face) { return face < 150; }; // nearly a third of 512
  EXPECT_EQ(cleaned(flipped(without(sphere(), cap))).triangles,
            cleaned(without(sphere(), cap)).triangles);
  EXPECT_EQ(cleaned(flipped(cylinder(1, 1, 32, false))).triangles,
            cylinder(1, 1, 32, false).triangles);
}

// The volume of a thin tub with a hole in it is small for its area.
TEST(CleanTriangles, OpenThinTubTurns) {
  const TriangleMesh tub = without(moved(box({0, 0, 0}, {1, 1, 1}, 8),
                                         [](const Vec3d& p) { // the top pushed down to the bottom
                                           const bool top = p[2] == 1 && std::min(p[0], p[1]) > 0 &&
                                                            std::max(p[0], p[1]) < 1;
                                           return Vec3d{p[0], p[1], top ? 0.04 : p[2]};
                                         }),
                                   [](std::size_t face) { return face == 100; });
  EXPECT_EQ(cleaned(tub).triangles, tub.triangles);
  TriangleMesh mesh = flipped(tub);
  EXPECT_TRUE(clean(mesh).insideOut);
  EXPECT_EQ(mesh.triangles, tub.triangles);
}

TEST(CleanTriangles, ShallowSheetsKeepTheirSide) {
  const TriangleMesh shallow = moved(sheet(), [](const Vec3d& p) {
    return Vec3d{p[0], p[1], 0.01 * (p[0] * p[0] + p[1] * p[1])};
  });
  EXPECT_EQ(cleaned(shallow).triangles, shallow.triangles);
  EXPECT_EQ(cleaned(flipped(shallow)).triangles, flipped(shallow).triangles);
}

TEST(CleanTriangles, OneComponentFlippedLeavesNoHole) {
  const TriangleMesh apart = joined({box(), sphere({2, 2, 2}, 0.7), torus(0.5, 0.2)});
  TriangleMesh spoiled = joined({box(), flipped(sphere({2, 2, 2}, 0.7)), torus(0.5, 0.2)});
  EXPECT_EQ(clean(spoiled).flippedParts, 1u);
  EXPECT_EQ(spoiled.triangles, apart.triangles);
  // Overlapping parts are not nested.
  const TriangleMesh overlapping = joined({box(), sphere({1, 1, 1}, 0.9)});
  EXPECT_EQ(cleaned(joined({box(), flipped(sphere({1, 1, 1}, 0.9))})).triangles,
            overlapping.triangles);
  // Nor are those of which less than half is inside, though their box is.
  const TriangleMesh corner = box({0.3, 0.3, 0.3}, {0.95, 0.95, 0.95});
  EXPECT_EQ(cleaned(joined({sphere(), flipped(corner)})).triangles,
            joined({sphere(), corner}).triangles);
}

// --- Nested parts. The spheres' facets lie inside them: radii are apart by more than that.

auto inShell(double inner, double outer) {
  return [=](const Vec3d& p) {
    const double r = std::hypot(p[0], p[1], p[2]);
    return r > inner && r < outer;
  };
}

// Probes near the spheres' radii are skipped.
template <typename Expected>
void expectBalls(const TriangleMesh& mesh, const Expected& expected) {
  int wrong = 0;
  for (const Vec3d& p : probes(1000)) {
    const double r = std::hypot(p[0], p[1], p[2]);
    if (std::abs(r - std::round(2 * r) / 2) < 0.05)
      continue;
    wrong += (windingNumberAt(mesh, p) > 0.5) != expected(p);
  }
  EXPECT_EQ(wrong, 0);
}

TEST(CleanTriangles, NestedHollowBallStaysHollow) {
  const TriangleMesh hollow = joined({ball(1), ball(0.5, true)});
  EXPECT_EQ(cleaned(hollow).triangles, hollow.triangles);
  expectBalls(cleaned(withFacesFlipped(hollow, 0.3)), inShell(0.5, 1));
}

TEST(CleanTriangles, NestedMirroredHollowBallStaysHollow) {
  TriangleMesh mesh = joined({ball(0.5), ball(1, true)});
  const CleanCounts counts = clean(mesh);
  EXPECT_TRUE(counts.insideOut);
  EXPECT_EQ(counts.flippedParts, 2u);
  expectBalls(mesh, inShell(0.5, 1));
}

TEST(CleanTriangles, NestedOutwardInOutwardIsFilled) {
  const TriangleMesh mesh = joined({ball(1), ball(0.5)});
  EXPECT_EQ(cleaned(mesh).triangles, mesh.triangles);
  expectBalls(cleaned(mesh), inShell(0, 1));
}

TEST(CleanTriangles, NestedThreeLevels) {
  const TriangleMesh mesh = joined({ball(1, true), ball(0.5), ball(1.5)});
  EXPECT_EQ(cleaned(mesh).triangles, mesh.triangles);
  const auto solid = [](const Vec3d& p) { return inShell(0, 0.5)(p) || inShell(1, 1.5)(p); };
  expectBalls(cleaned(mesh), solid);
  expectBalls(cleaned(flipped(mesh)), solid);
  // A body in the cavity that is inside out is turned, with its own cavity.
  expectBalls(cleaned(joined({ball(1, true), ball(0.5, true), ball(1.5)})), solid);
  TriangleMesh four = joined({ball(2), ball(1.5, true), ball(1, true), ball(0.5)});
  EXPECT_EQ(clean(four).flippedParts, 2u);
  expectBalls(four, [](const Vec3d& p) { return inShell(0.5, 1)(p) || inShell(1.5, 2)(p); });
}

TEST(CleanTriangles, NestedInAnOpenPart) {
  // A ball that looks inward in a cup: the cup's opening is small enough for most samples.
  const TriangleMesh cup = without(ball(1.5), [](std::size_t face) { return face < 100; });
  expectBalls(cleaned(joined({cup, ball(0.5, true)})),
              [&](const Vec3d& p) { return windingNumberAt(cup, p) > 0.5 && !inShell(0, 0.5)(p); });
}

// --- Edges of several faces.

TEST(CleanTriangles, BoxesThatShareAnEdge) {
  const auto solid = [](const Vec3d& p) {
    const bool first = p[0] > 0 && p[0] < 1 && p[1] > 0 && p[1] < 1;
    const bool second = p[0] > 1 && p[0] < 2 && p[1] > 1 && p[1] < 2;
    return p[2] > 0 && p[2] < 1 && (first || second);
  };
  const TriangleMesh a = box(), b = box({1, 1, 0}, {2, 2, 1});
  for (const TriangleMesh& mesh : {joined({a, b}), joined({a, flipped(b)}), joined({flipped(a), b}),
                                   flipped(joined({a, b})), withFacesFlipped(joined({a, b}), 0.3)})
    expectSolid(cleaned(unwelded(mesh)), solid);
}

TEST(CleanTriangles, PatchesAroundAnEdgeOfFourFacesAreAligned) {
  // A box cut by its own diagonal walls into patches that meet four to an edge: two wedges that
  // touch in an edge, given as six quads each turned by chance.
  const TriangleMesh wedges = [] {
    TriangleMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0},
                   {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {-1, 0, 1}, {0, -1, 1}};
    const auto prism = [&](std::uint32_t p, std::uint32_t q) {
      addTriangle(mesh, 0, q, p);
      addTriangle(mesh, 5, p + 5, q + 5);
      const std::uint32_t around[4] = {0, p, q, 0};
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t u = around[k], v = around[k + 1];
        addTriangle(mesh, u, v, v + 5);
        addTriangle(mesh, u, v + 5, u + 5);
      }
    };
    prism(1, 2);
    prism(3, 4);
    return mesh;
  }();
  ASSERT_NEAR(signedVolume(wedges), 1, 1e-12);
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    EXPECT_NEAR(signedVolume(cleaned(withFacesFlipped(wedges, 0.5, seed))), 1, 1e-12);
}

// Two boxes and the one wall between them, which has two others at each of its edges: three
// patches. The boxes stand in a third, so that rays cross that too.
TEST(CleanTriangles, PatchesAtAWallWithinAnotherShellDoNoHarm) {
  const TriangleMesh left = without(box(), [](std::size_t f) { return f == 2 || f == 3; });
  const TriangleMesh wall = without(box(), [](std::size_t f) { return f != 2 && f != 3; });
  const TriangleMesh right =
      without(box({1, 0, 0}, {2, 1, 1}), [](std::size_t f) { return f < 2; });
  for (int turned = 0; turned < 8; ++turned) {
    TriangleMesh mesh =
        joined({turned & 1 ? flipped(left) : left, turned & 2 ? flipped(right) : right,
                turned & 4 ? flipped(wall) : wall});
    append(mesh, box({-1, -1, -1}, {2.5, 2.5, 2.5}));
    clean(mesh);
    expectSolid(mesh, inBox(-1, 2.5));
  }
}

TEST(CleanTriangles, WallsWithinTheSolidAreDropped) {
  for (const bool reversed : {false, true}) {
    TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1}, 4);
    const std::size_t faces = mesh.triangleCount();
    TriangleMesh wall = sheet(4, 0.5); // ends on the box, half way up
    append(mesh, reversed ? flipped(wall) : wall);
    const CleanCounts counts = clean(mesh);
    EXPECT_EQ(counts.innerFaces, wall.triangleCount());
    EXPECT_EQ(mesh.triangleCount(), faces);
    expectSolid(mesh, inBox(0, 1));
  }
}

// As found in a model of a bracket: faces that are there twice, a few open edges, and parts that
// the rest touches along edges of four faces.
TEST(CleanTriangles, FlangesOfABracketAreKept) {
  TriangleMesh mesh = box({0, 0, 0}, {2, 1, 1});
  append(mesh, box({-2, 0, 0}, {0, 1, 0.1}, 2)); // its end lies in the block's side
  append(mesh, box({2, 0, 0}, {4, 1, 0.1}, 2));
  TriangleMesh doubled = without(mesh, [](std::size_t face) { return face % 5 != 0; });
  mesh = without(mesh, [](std::size_t face) { return face == 30; });
  append(mesh, doubled);
  clean(mesh);
  int wrong = 0;
  for (const double x : {-1.7, -0.9, -0.3, 0.4, 1.6, 2.3, 3.1, 3.8})
    for (const double y : {0.2, 0.55, 0.85})
      wrong += windingNumberAt(mesh, {x, y, 0.053}) <= 0.5;
  EXPECT_EQ(wrong, 0);
}

// Two boxes that touch with walls cut along other diagonals, one inside out.
TEST(CleanTriangles, TouchingBoxInsideOutIsTurned) {
  TriangleMesh other = box({1, 0, 0}, {2, 1, 1});
  for (TriangleMesh mesh : {joined({box(), flipped(other)}), joined({flipped(box()), other})}) {
    clean(mesh);
    expectSolid(mesh, [](const Vec3d& p) {
      return p[0] > 0 && p[0] < 2 && std::min(p[1], p[2]) > 0 && std::max(p[1], p[2]) < 1;
    });
  }
}

TEST(CleanTriangles, PatchBehindTJunctionsIsTurned) {
  // A box whose lid has more points along its boundary, and looks inward.
  TriangleMesh mesh =
      without(box({0, 0, 0}, {1, 1, 1}, 2), [](std::size_t face) { return face >= 40; });
  TriangleMesh lid = moved(sheet(3, 1), [](Vec3d p) { return p; });
  append(mesh, flipped(lid));
  clean(mesh);
  expectSolid(mesh, inBox(0, 1));
}

TEST(CleanTriangles, FinsGetNoSide) {
  const TriangleMesh solid = box();
  TriangleMesh mesh = solid;
  mesh.points.push_back({2, 0.5, 0.5});
  addTriangle(mesh, 6, 7, 8); // sticks out
  const TriangleMesh before = mesh;
  EXPECT_EQ(cleaned(mesh).triangles, before.triangles);
  mesh.points.push_back({0.5, 0.5, 0.5});
  addTriangle(mesh, 0, 1, 9); // sticks into, and goes
  EXPECT_EQ(cleaned(mesh).triangles, before.triangles);
  TriangleMesh turned = cleaned(flipped(mesh));
  turned.triangles.resize(solid.triangles.size());
  EXPECT_EQ(turned.triangles, solid.triangles);
}

} // namespace
} // namespace tetvdb
