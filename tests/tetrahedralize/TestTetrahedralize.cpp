// SPDX-License-Identifier: Apache-2.0
//
// Shapes that meshers are known to stumble over.
#include "tetrahedralize/MadeTets.h"
#include "tetvdb/core/Constants.h"

#include <array>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using meshes::box;
using meshes::joined;
using meshes::signedVolume;
using meshes::sphere;

TriangleMesh turned(const TriangleMesh& mesh, double angle = 0.7, const Vec3d& by = {0, 0, 0}) {
  const double c = std::cos(angle), s = std::sin(angle);
  return meshes::moved(mesh, [&](const Vec3d& p) {
    const Vec3d q{c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]};
    return plus({q[0], c * q[1] - s * q[2], s * q[1] + c * q[2]}, by);
  });
}

TriangleMesh shifted(const TriangleMesh& mesh, const Vec3d& by) {
  return meshes::moved(mesh, [&](const Vec3d& p) { return plus(p, by); });
}

TriangleMesh cone(double radius, double height, int around) {
  TriangleMesh mesh;
  mesh.points = {{0, 0, 0}, {0, 0, height}};
  for (int i = 0; i < around; ++i)
    mesh.points.push_back(
        {radius * std::cos(2 * kPi * i / around), radius * std::sin(2 * kPi * i / around), 0});
  for (int i = 0; i < around; ++i) {
    const auto a = static_cast<std::uint32_t>(2 + i);
    const auto b = static_cast<std::uint32_t>(2 + (i + 1) % around);
    meshes::addTriangle(mesh, a, b, 1);
    meshes::addTriangle(mesh, b, a, 0);
  }
  return mesh;
}

// A prism of height 1 over a polygon that is seen whole from 0.
TriangleMesh prism(const std::vector<std::array<double, 2>>& polygon) {
  TriangleMesh mesh;
  mesh.points = {{0, 0, 0}, {0, 0, 1}};
  for (const auto& [x, y] : polygon) {
    mesh.points.push_back({x, y, 0});
    mesh.points.push_back({x, y, 1});
  }
  const auto n = static_cast<std::uint32_t>(polygon.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % n);
    meshes::addTriangle(mesh, a, b, b + 1);
    meshes::addTriangle(mesh, a, b + 1, a + 1);
    meshes::addTriangle(mesh, 0, b, a);
    meshes::addTriangle(mesh, 1, a + 1, b + 1);
  }
  return mesh;
}

TEST(Tetrahedralize, CleanSolids) {
  expectSolid(box(), 1);
  expectSolid(box({0, 0, 0}, {1, 2, 3}, 4), 6);
  for (const TriangleMesh& mesh :
       {sphere({0, 0, 0}, 1, 12), meshes::torus(), turned(meshes::torus()),
        meshes::cylinder(1, 2, 40), turned(box({0, 0, 0}, {1, 1, 1}, 5))})
    expectSolid(mesh, signedVolume(mesh));
}

TEST(Tetrahedralize, SolidsThatOverlapAreOne) {
  expectSolid(joined({box(), box({0.5, 0.25, 0.125}, {1.5, 1.25, 1.125})}), 2 - 0.5 * 0.75 * 0.875);
  expectSolid(joined({sphere({0, 0, 0}, 1, 8), turned(box(), 0.7, {0.3, 0.2, 0.1})}));
  // The same plane, the same way; the walls nearly coincide.
  expectSolid(joined({box(), box({0.5, 0.25, 0}, {1.5, 1.25, 1})}), 2 - 0.5 * 0.75);
  expectSolid(joined({box(), box({0.5, 0.25, 1e-9}, {1.5, 1.25, 1 + 1e-9})}), 2 - 0.5 * 0.75);
}

TEST(Tetrahedralize, ATubeThroughItself) {
  // Along a figure of eight: where the tube meets itself the winding number
  // is 2.
  const TriangleMesh mesh = meshes::moved(meshes::torus(1, 0.2, 48, 12), [](const Vec3d& p) {
    const double u = std::atan2(p[1], p[0]), r = std::hypot(p[0], p[1]) - 1;
    const Vec3d along{std::cos(u), std::cos(2 * u), 0};
    const double size = length(along);
    return Vec3d{std::sin(u) + r * along[1] / size, std::sin(2 * u) / 2 - r * along[0] / size,
                 p[2]};
  });
  expectSolid(mesh);
}

TEST(Tetrahedralize, SoupsOfTheSameSolid) {
  const TriangleMesh mesh = sphere({0, 0, 0}, 1, 8);
  const double volume = signedVolume(mesh);
  TriangleMesh wall = joined({box(), meshes::flipped(box())});
  wall.triangles.resize(3 * 13); // one face once more, reversed
  for (const TriangleMesh& same :
       {meshes::unwelded(mesh), meshes::flipped(mesh), meshes::shuffledFaces(mesh),
        meshes::withFacesFlipped(mesh, 0.05), meshes::withFacesFlipped(mesh, 0.3),
        joined({mesh, mesh})})
    expectSolid(same, volume);
  expectSolid(joined({mesh, meshes::flipped(shifted(mesh, {3, 0, 0}))}), 2 * volume);
  (void)madeTets({wall}, {}); // a hole or none: no crash
}

TEST(Tetrahedralize, Holes) {
  expectSolid(meshes::without(box({0, 0, 0}, {1, 1, 1}, 3), [](std::size_t f) { return f < 18; }));
  for (const std::size_t hole : {6u, 150u})
    expectSolid(meshes::without(sphere({0, 0, 0}, 1, 8), [&](std::size_t f) { return f < hole; }));
  expectSolid(meshes::cylinder(1, 3, 32, false));
}

TEST(Tetrahedralize, SheetsAreSaidToBeSheets) {
  TriangleMesh triangle;
  triangle.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.3}};
  triangle.triangles = {0, 1, 2};
  for (const TriangleMesh& mesh : {meshes::sheet(4), turned(meshes::sheet(4)), triangle,
                                   meshes::moved(sphere(), [](const Vec3d& p) {
                                     return Vec3d{p[0], p[1], 0};
                                   })}) {
    const MadeTets made = madeTets({mesh}, {});
    EXPECT_EQ(made.error, Status::Invalid) << made.message;
  }
}

TEST(Tetrahedralize, WhatIsNotAManifold) {
  expectSolid(joined({box(), box({1, 1, 0}, {2, 2, 1})}),
              2);                                             // an edge in common
  expectSolid(joined({box(), box({1, 1, 1}, {2, 2, 2})}), 2); // a point
  expectSolid(joined({box(), box({1, 0, 0}, {2, 1, 1})}), 2); // a face
  expectSolid(joined({box(), box({1, 0.3, 0.2}, {2, 1.3, 1.2})}),
              2); // parts of faces
  // T-junctions: one side of the box is cut finer than those about it.
  const auto notLow = [](std::size_t f) { return f >= 32; };
  expectSolid(joined({meshes::without(box(), [](std::size_t f) { return f < 2; }),
                      meshes::without(box({0, 0, 0}, {1, 1, 1}, 4), notLow)}),
              1);
}

TEST(Tetrahedralize, FinsAddNoVolume) {
  const TriangleMesh fin = shifted(meshes::sheet(3), {0.5, 0.1, 0.45});
  for (const TriangleMesh& mesh :
       {joined({box(), fin}), joined({box(), meshes::moved(fin, [](const Vec3d& p) {
                                        return Vec3d{0.2 + 0.3 * p[0], 0.2 + 0.3 * p[1], p[2]};
                                      })})}) {
    const MadeTets made = expectSolid(mesh);
    EXPECT_NEAR(made.result.check.volume, 1, 0.02);
  }
}

TEST(Tetrahedralize, InnerWallsOfFiveSheets) {
  TriangleMesh mesh = box();
  for (int i = 1; i <= 5; ++i) {
    const TriangleMesh sheet = meshes::sheet(2, i / 6.0);
    meshes::append(mesh, i % 2 == 0 ? sheet : meshes::flipped(sheet));
  }
  expectSolid(mesh);
}

TEST(Tetrahedralize, NestedShells) {
  const TriangleMesh large = sphere({0, 0, 0}, 1, 8), midpoint = sphere({0, 0, 0}, 0.6, 6),
                     small = sphere({0, 0, 0}, 0.3, 4);
  const double v = signedVolume(large), w = signedVolume(midpoint), u = signedVolume(small);
  expectSolid(joined({large, meshes::flipped(midpoint)}), v - w);
  expectSolid(joined({large, midpoint}), v);
  expectSolid(joined({large, meshes::flipped(midpoint), small}), v - w + u);
}

TEST(Tetrahedralize, DegenerateFaces) {
  // Every face of the box in three from a point near the middle of one of its
  // edges, or on it.
  for (const double share : {0.0, 1e-12, 1e-6, 1e-3}) {
    const TriangleMesh mesh = turned(box({0, 0, 0}, {1, 1, 1}, 2));
    TriangleMesh capped;
    capped.points = mesh.points;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
      const auto n = static_cast<std::uint32_t>(capped.points.size());
      const std::array<std::uint32_t, 3> f{mesh.triangles[i], mesh.triangles[i + 1],
                                           mesh.triangles[i + 2]};
      const Vec3d &a = mesh.points[f[0]], &b = mesh.points[f[1]], &c = mesh.points[f[2]];
      capped.points.push_back(plus(times(a, 0.6 - share), plus(times(b, 0.4), times(c, share))));
      meshes::addTriangle(capped, f[0], f[1], n);
      meshes::addTriangle(capped, f[1], f[2], n);
      meshes::addTriangle(capped, f[2], f[0], n);
    }
    expectSolid(capped, 1);
  }
}

TEST(Tetrahedralize, ThinPlates) {
  TetrahedralizeOptions options;
  options.epsilon = 4e-3;
  const auto plate = [&](double thickness, double angle) {
    return turned(box({0, 0, 0}, {1, 1, thickness * options.epsilon}), angle);
  };
  for (const double angle : {0.0, 0.0175, 0.7854}) {
    // Thin ones may vanish; if so it is said, and what is there is within
    // epsilon of the plate.
    for (const double thickness : {10.0, 2.0, 1.0, 0.5, 0.1}) {
      const MadeTets made = madeTets({plate(thickness, angle)}, options);
      if (made.error && thickness <= 2) {
        EXPECT_EQ(made.error, Status::Invalid) << made.message;
        continue;
      }
      ASSERT_FALSE(made.error) << made.message;
      const TetMeshCheck check = checkOf(made);
      EXPECT_EQ(check.faults(), "") << check.json();
      if (thickness > 2) {
        EXPECT_NEAR(check.volume, thickness * options.epsilon,
                    areaOf(made.cleaned[0]) * options.epsilon / 2);
        EXPECT_LE(check.inToOut, 1.5 * options.epsilon);
      }
      EXPECT_TRUE(check.lostPoints <= 1 || made.report.partial) << check.json();
    }
  }
}

// Both sides of a plate are within epsilon of one another: what is made within all of epsilon may
// be half as thick.
TEST(Tetrahedralize, ThinPlatesKeepTheirVolume) {
  TetrahedralizeOptions options;
  options.epsilon = 4e-3;
  int halved = 0;
  for (const double angle : {0.0, 0.7854})
    for (const double thickness : {0.55, 0.9, 1.3, 4.0}) {
      const MadeTets made =
          madeTets({turned(box({0, 0, 0}, {1, 1, thickness * options.epsilon}), angle)}, options);
      ASSERT_FALSE(made.error) << made.message;
      EXPECT_FALSE(made.report.partial) << thickness;
      const TetMeshCheck check = checkOf(made);
      EXPECT_EQ(check.faults(), "") << check.json();
      const double volume = thickness * options.epsilon;
      EXPECT_NEAR(check.volume, volume, 0.06 * volume) << thickness;
      const double share = made.result.epsilonUsed / options.epsilon;
      EXPECT_TRUE(share == 1 || share == 0.5 || share == 0.25 || share == 0.125 || share == 0.0625)
          << share;
      EXPECT_TRUE(share == 1 || thickness < 2);
      EXPECT_EQ(made.result.epsilonAsked, options.epsilon);
      halved += share < 1;
    }
  EXPECT_GE(halved, 4);
}

// A saddle of two sheets, `thickness` apart, with a wall around them.
TriangleMesh saddle(double thickness, std::uint32_t n) {
  TriangleMesh mesh;
  for (const double above : {0.0, thickness})
    for (std::uint32_t i = 0; i <= n; ++i)
      for (std::uint32_t j = 0; j <= n; ++j) {
        const double x = -1 + 2.0 * i / n, y = -1 + 2.0 * j / n;
        mesh.points.push_back({x, y, 0.3 * (x * x - y * y) + above});
      }
  const std::uint32_t upper = (n + 1) * (n + 1);
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return i * (n + 1) + j; };
  const auto addWall = [&](std::uint32_t a, std::uint32_t b) {
    meshes::addTriangle(mesh, a, b, upper + b);
    meshes::addTriangle(mesh, a, upper + b, upper + a);
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      for (const auto& [p, q, r] : {std::array{a, b, c}, std::array{a, c, d}}) {
        meshes::addTriangle(mesh, p, r, q);
        meshes::addTriangle(mesh, upper + p, upper + q, upper + r);
      }
    }
    addWall(at(i, 0), at(i + 1, 0));
    addWall(at(n, i), at(n, i + 1));
    addWall(at(i + 1, n), at(i, n));
    addWall(at(0, i + 1), at(0, i));
  }
  return mesh;
}

// Simplification alone would move many of the two sides onto each other.
TEST(Tetrahedralize, ThinCurvedPartsStay) {
  TetrahedralizeOptions options;
  options.epsilon = 1e-2;
  for (const double thickness : {0.6, 1.6, 2.0}) {
    const MadeTets made =
        madeTets({joined({sphere({0, 0, 0}, 0.5, 16),
                          shifted(saddle(thickness * options.epsilon, 24), {0, 2.5, 0})})},
                 options);
    ASSERT_FALSE(made.error) << made.message;
    EXPECT_EQ(made.result.check.lostPoints, 0u) << thickness;
    EXPECT_FALSE(made.report.partial) << thickness;
    const TetMeshCheck check = checkOf(made);
    EXPECT_EQ(check.faults(), "") << check.json();
    EXPECT_LE(check.inToOut, 1.05 * options.epsilon) << check.json();
  }
}

TEST(Tetrahedralize, GapsWiderThanTwoEpsilonStay) {
  TetrahedralizeOptions options;
  options.epsilon = 2e-3;
  for (const double gap : {10.0, 4.0, 0.5}) {
    const double right = 1 + gap * options.epsilon;
    const MadeTets made =
        expectSolid(joined({box(), box({right, 0, 0}, {right + 1, 1, 1})}), 2, options);
    if (gap < 2 || made.error)
      continue;
    // No tet lies in the gap.
    const TetMesh& mesh = made.result.mesh;
    for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
      double x = 0;
      for (std::size_t k = 0; k < 4; ++k)
        x += mesh.points[mesh.tets[4 * t + k]][0] / 4;
      EXPECT_FALSE(x > 1 + options.epsilon && x < right - options.epsilon);
    }
  }
}

TEST(Tetrahedralize, SizesAndPlaces) {
  const TriangleMesh mesh = turned(meshes::torus(1, 0.4, 20, 10));
  const double volume = signedVolume(mesh);
  for (const double factor : {1e8, 1e-8})
    expectSolid(meshes::moved(mesh, [&](const Vec3d& p) { return times(p, factor); }),
                volume * factor * factor * factor);
  for (const double far : {1e6, -1e8})
    expectSolid(shifted(mesh, {far, -far, far}), volume);
  TetrahedralizeOptions options;
  options.epsilon = 0.02;
  expectSolid(turned(box({0, 0, 0}, {1, 1, 1000})), 1000, options);
}

TEST(Tetrahedralize, SharpTips) {
  for (const TriangleMesh& mesh : {cone(0.2, 2, 24), cone(1, 0.1, 24),
                                   prism({{-0.5, -0.009}, {0.5, 0}, {-0.5, 0.009}})}) // 1 degree
    expectSolid(mesh, signedVolume(mesh));
  std::vector<std::array<double, 2>> star, gear;
  for (int i = 0; i < 24; ++i) {
    const double u = 2 * kPi * i / 24;
    const double r = i % 2 == 0 ? 1 : 0.3, g = i % 4 < 2 ? 1 : 0.8;
    star.push_back({r * std::cos(u), r * std::sin(u)});
    gear.push_back({g * std::cos(u), g * std::sin(u)});
  }
  for (const auto& polygon : {star, gear}) {
    const TriangleMesh mesh = turned(prism(polygon));
    expectSolid(mesh, signedVolume(mesh));
  }
}

TEST(Tetrahedralize, DetailBelowEpsilonGoes) {
  meshes::Random random(1);
  TriangleMesh mesh = sphere({0, 0, 0}, 1, 24);
  for (Vec3d& p : mesh.points)
    p = times(p, 1 + 2e-3 * (random.unit() - 0.5));
  TetrahedralizeOptions options;
  options.epsilon = 1e-2;
  const MadeTets made = expectSolid(mesh, signedVolume(mesh), options);
  EXPECT_LT(made.result.simplifiedFaces, mesh.triangleCount() / 4);
}

TEST(Tetrahedralize, ManyParts) {
  TriangleMesh mesh;
  for (int i = 0; i < 216; ++i)
    meshes::append(mesh, sphere({double(i % 6), double(i / 6 % 6), double(i / 36)}, 0.4, 2));
  expectSolid(mesh, signedVolume(mesh));
}

TEST(Tetrahedralize, HugeTrianglesBesideSmallOnes) {
  expectSolid(joined({box({-2, -2, -0.2}, {3, 3, 0}), box({0.3, 0.2, 0}, {0.45, 0.35, 0.1}, 8)}));
  expectSolid(turned(
      joined({box({-2, -2, -0.2}, {3, 3, 0}), box({0.3, 0.2, -0.05}, {0.45, 0.35, 0.1}, 8)})));
}

TEST(Tetrahedralize, FansOfHundredsOfTriangles) {
  for (const TriangleMesh& mesh : {meshes::cylinder(1, 1, 200), cone(1, 1, 300)})
    expectSolid(mesh, signedVolume(mesh));
}

TEST(Tetrahedralize, RandomSoups) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    meshes::Random random(seed);
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < 60; ++i) {
      mesh.points.push_back({random.unit(), random.unit(), random.unit()});
      mesh.triangles.push_back(i);
    }
    const MadeTets made = madeTets({mesh}, {});
    if (made.error)
      EXPECT_EQ(made.error, Status::Invalid) << made.message;
    else
      expectNoFaults(checkOf(made));
  }
}

} // namespace
} // namespace tetvdb
