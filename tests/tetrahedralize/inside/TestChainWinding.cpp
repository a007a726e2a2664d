// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/tetrahedralize/inside/ChainWinding.h"
#include "tetvdb/voxelize/SoupBoundary.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace tetvdb {
namespace {

LatticePoint latticePoint(const Vec3d& p) {
  return {p[0], p[1], p[2]};
}

ChainWinding windingOf(const TriangleMesh& mesh) {
  Progress progress;
  const auto at = [&](std::uint32_t point) { return latticePoint(mesh.points[point]); };
  std::vector<ChainWinding::Face> faces;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3)
    faces.push_back(
        {at(mesh.triangles[i]), at(mesh.triangles[i + 1]), at(mesh.triangles[i + 2]), 1});
  std::vector<BoundaryEdge> boundary;
  for (const IndexedBoundaryEdge& edge : soupBoundary(mesh, progress).edges)
    boundary.push_back({at(edge.a), at(edge.b), edge.weight});
  return ChainWinding(std::move(faces), std::move(boundary));
}

TriangleMesh onLattice(const TriangleMesh& mesh, double scale) {
  return meshes::moved(mesh, [&](Vec3d p) {
    for (double& c : p)
      c = std::nearbyint(c * scale);
    return p;
  });
}

// Away from faces, where the solid angles' sum is sure.
void expectAsBruteForce(const TriangleMesh& mesh, const std::vector<LatticePoint>& points,
                        double tolerance) {
  Progress progress;
  const std::vector<double> winding = windingOf(mesh).at(points, progress);
  ASSERT_EQ(winding.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d p{points[i].x, points[i].y, points[i].z};
    EXPECT_NEAR(winding[i], meshes::windingNumberAt(mesh, p), tolerance)
        << p[0] << ' ' << p[1] << ' ' << p[2];
  }
}

TEST(ChainWinding, IsWholeUnderAndOverTheCornersAndEdgesOfACube) {
  TriangleMesh cube;
  for (int i = 0; i < 8; ++i)
    cube.points.push_back({(i & 1) * 8.0, (i >> 1 & 1) * 8.0, (i >> 2 & 1) * 8.0});
  cube.triangles = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  std::vector<LatticePoint> points;
  for (int x = -2; x <= 10; x += 2)
    for (int y = -2; y <= 10; y += 2)
      for (int z = -2; z <= 10; z += 2)
        points.push_back({double(x), double(y), double(z)});
  Progress progress;
  const std::vector<double> winding = windingOf(cube).at(points, progress);
  // A point on the cube is the one that it is moved to: half-open along every axis.
  const auto isIn = [](double c) { return c >= 0 && c < 8; };
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_EQ(winding[i], isIn(points[i].x) && isIn(points[i].y) && isIn(points[i].z) ? 1 : 0)
        << points[i].x << ' ' << points[i].y << ' ' << points[i].z;
}

TEST(ChainWinding, OfAnOpenSphereIsTheSumOfSolidAngles) {
  const TriangleMesh whole = meshes::sphere({0, 0, 0}, 1, 20);
  const TriangleMesh open =
      onLattice(meshes::without(whole,
                                [&](std::size_t face) {
                                  return whole.points[whole.triangles[3 * face]][2] > 0.6;
                                }),
                1e9);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> along(-1.5e9, 1.5e9);
  std::vector<LatticePoint> points;
  for (int i = 0; i < 3000; ++i)
    points.push_back({std::nearbyint(along(random)), std::nearbyint(along(random)),
                      std::nearbyint(along(random))});
  expectAsBruteForce(open, points, kBoundaryWindingError);
}

TEST(ChainWinding, IsTheSameInColumnsAndInCubes) {
  const TriangleMesh sphere = onLattice(meshes::sphere({0, 0, 0}, 1, 20), 1e9);
  const ChainWinding winding = windingOf(sphere);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> along(-1.2e9, 1.2e9);
  const auto place = [&] { return std::nearbyint(along(random)); };
  std::vector<LatticePoint> spread, upright, line;
  for (int i = 0; i < 3000; ++i) {
    spread.push_back({place(), place(), place()});
    upright.push_back({1e8, -2e8, place()}); // all of one column
    line.push_back({place(), 3e8, 1e8});
  }
  const std::vector<LatticePoint> one(300, {7, 8, 9});
  Progress progress;
  for (const auto& points : {spread, upright, line, one, {}}) {
    const PointGroups columns(points, PointGroups::Shape::Columns),
        cubes(points, PointGroups::Shape::Cubes);
    const std::vector<double> found = winding.at(columns, progress);
    EXPECT_EQ(found, winding.at(cubes, progress));
    expectAsBruteForce(sphere, points, 1e-6);
    for (const PointGroups* groups : {&columns, &cubes}) {
      std::vector<int> times(points.size(), 0);
      for (const std::uint32_t number : groups->numbers)
        ++times[number];
      EXPECT_EQ(times, std::vector<int>(points.size(), 1));
      for (std::size_t i = 0; i < groups->size(); ++i)
        EXPECT_LE(groups->begins[i + 1] - groups->begins[i], 64u);
    }
  }
}

TEST(ChainWinding, OfATangleOnFewCoordinatesIsTheSumOfSolidAngles) {
  std::mt19937_64 random(2);
  std::uniform_int_distribution<int> corner(0, 6);
  TriangleMesh tangle;
  for (int i = 0; i < 3 * 60; ++i)
    tangle.points.push_back({64.0 * corner(random), 64.0 * corner(random), 64.0 * corner(random)});
  for (std::uint32_t i = 0; i < 180; ++i)
    tangle.triangles.push_back(i);
  // Over and under points and edges, but off the coordinates of most faces.
  std::vector<LatticePoint> points;
  for (int i = 0; i < 1000; ++i)
    points.push_back({64.0 * corner(random), 64.0 * corner(random), 64.0 * corner(random) + 37});
  Progress progress;
  const std::vector<double> winding = windingOf(tangle).at(points, progress);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    // On a face the sum is the mean of both sides; there it changes at once.
    const Vec3d p{points[i].x, points[i].y, points[i].z};
    const auto shifted = [&](double way) {
      return meshes::windingNumberAt(tangle, {p[0] + way, p[1] + 0.7 * way, p[2] + 0.3 * way});
    };
    if (std::abs(shifted(1e-3) - shifted(-1e-3)) > 0.1)
      continue;
    ++compared;
    EXPECT_NEAR(winding[i], shifted(1e-3), kBoundaryWindingError + 1e-3) << p[0] << ' ' << p[1];
  }
  EXPECT_GT(compared, 800u);
}

TEST(ChainWinding, StaysRoundOnlyWhereItDoes) {
  const TriangleMesh whole = meshes::sphere({0, 0, 0}, 1, 20);
  const TriangleMesh open =
      onLattice(meshes::without(whole,
                                [&](std::size_t face) {
                                  return whole.points[whole.triangles[3 * face]][2] > 0.9;
                                }),
                1e9);
  const ChainWinding winding = windingOf(open);
  EXPECT_TRUE(winding.staysRound({0, 0, -9e8}, 3e8));
  EXPECT_FALSE(winding.staysRound({0, 0, -9e8}, 2e9));
  EXPECT_FALSE(winding.staysRound({0, 0, 9e8}, 1e7));
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> along(-1.3e9, 1.3e9), share(-1, 1);
  std::size_t round = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d centre{along(random), along(random), along(random)};
    const double reach = std::exp2(22 + 8 * std::abs(share(random)));
    if (!winding.staysRound(centre, reach))
      continue;
    ++round;
    const double step = reach / std::sqrt(3.0);
    const double here = meshes::windingNumberAt(open, {centre[0] + step * share(random),
                                                       centre[1] + step * share(random),
                                                       centre[2] + step * share(random)});
    EXPECT_LT(std::abs(here - std::nearbyint(here)), 0.5 - ChainWinding::kFromHalf);
  }
  EXPECT_GT(round, 500u);
}

} // namespace
} // namespace tetvdb
