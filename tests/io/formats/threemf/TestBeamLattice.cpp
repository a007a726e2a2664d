// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/formats/threemf/BeamLattice.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <sys/resource.h>
#include <utility>

namespace tetvdb {
namespace {

TriangleMesh meshOf(const BeamLattice& lattice, const std::vector<Vec3d>& vertices) {
  LatticeFaces faces = facesOfLattice(lattice, vertices, "lattice");
  EXPECT_EQ(faces.invalid, 0U);
  TriangleMesh mesh;
  mesh.points = std::move(faces.points);
  mesh.triangles = std::move(faces.triangles);
  return mesh;
}

/// Every edge is there as often in one direction as in the other.
void expectClosed(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t a = mesh.triangles[i], b = mesh.triangles[i % 3 == 2 ? i - 2 : i + 1];
    edges[std::minmax(a, b)] += a < b ? 1 : -1;
  }
  for (const auto& [edge, sum] : edges)
    EXPECT_EQ(sum, 0) << edge.first << ' ' << edge.second;
}

const std::vector<Vec3d> kVertices = {{1, 2, 3}, {4, 0, 5}};

TEST(BeamLattice, VolumesOfCaps) {
  const double distance = std::sqrt(17.0), a = 0.5, b = 0.25;
  const double frustum = kPi * distance * (a * a + a * b + b * b) / 3;
  const auto half = [](double r) { return 2 * kPi * r * r * r / 3; };
  const std::pair<std::array<BeamCap, 2>, double> cases[] = {
      {{BeamCap::Butt, BeamCap::Butt}, frustum},
      {{BeamCap::Hemisphere, BeamCap::Butt}, frustum + half(a)},
      {{BeamCap::Butt, BeamCap::Hemisphere}, frustum + half(b)},
      {{BeamCap::Hemisphere, BeamCap::Hemisphere}, frustum + half(a) + half(b)},
      {{BeamCap::Sphere, BeamCap::Sphere}, frustum + 2 * half(a) + 2 * half(b)}};
  for (const auto& [caps, volume] : cases) {
    const TriangleMesh mesh = meshOf({{{{0, 1}, {a, b}, caps}}, {}, false, ""}, kVertices);
    expectClosed(mesh);
    const bool isExact = caps[0] != BeamCap::Hemisphere && caps[1] != BeamCap::Hemisphere;
    EXPECT_NEAR(meshes::signedVolume(mesh), volume, isExact ? 1e-12 : 0.02 * (half(a) + half(b)));
  }
}

// Against the distances of points from segments, for beams in all directions.
TEST(BeamLattice, PointsInsideAreThoseOfTheCones) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1, 1), size(0.1, 0.4);
  for (int round = 0; round < 40; ++round) {
    const std::vector<Vec3d> ends = {{place(random), place(random), place(random)},
                                     {place(random), place(random), place(random)}};
    const double radius[2] = {size(random), size(random)};
    const auto caps = static_cast<BeamCap>(round % 3);
    const TriangleMesh mesh =
        meshOf({{{{0, 1}, {radius[0], radius[1]}, {caps, caps}}}, {}, false, ""}, ends);
    // Whether the solid with all radii times `scale`, flat ends moved as much, has the point.
    const auto isIn = [&](const Vec3d& p, double scale) {
      double along = 0, square = 0, squares[2] = {0, 0};
      for (std::size_t k = 0; k < 3; ++k) {
        const double way = ends[1][k] - ends[0][k];
        along += way * (p[k] - ends[0][k]);
        square += way * way;
        for (std::size_t e = 0; e < 2; ++e)
          squares[e] += (p[k] - ends[e][k]) * (p[k] - ends[e][k]);
      }
      const double t = along / square, r = radius[0] + t * (radius[1] - radius[0]);
      const double across = std::sqrt(std::max(0.0, squares[0] - along * along / square));
      const double slack = (scale - 1) * std::max(radius[0], radius[1]) / std::sqrt(square);
      if (t > -slack && t < 1 + slack && across < r * scale)
        return true;
      for (std::size_t e = 0; e < 2; ++e)
        if (squares[e] < radius[e] * radius[e] * scale * scale &&
            (caps == BeamCap::Sphere || (caps == BeamCap::Hemisphere && (e == 0 ? t < 0 : t > 1))))
          return true;
      return false;
    };
    int inside = 0;
    for (int i = 0; i < 400; ++i) {
      const double t = 0.5 + place(random);
      Vec3d p;
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = ends[0][k] + t * (ends[1][k] - ends[0][k]) + 0.6 * place(random);
      const double winding = meshes::windingNumberAt(mesh, p);
      if (isIn(p, 0.97)) {
        ++inside;
        EXPECT_GT(winding, 0.5);
      } else if (!isIn(p, 1.03)) {
        EXPECT_LT(winding, 0.5);
      }
    }
    EXPECT_GT(inside, 0);
  }
}

TEST(BeamLattice, BallsOfSeveralBeamsAreOne) {
  const std::array<BeamCap, 2> caps = {BeamCap::Sphere, BeamCap::Sphere};
  const std::vector<Vec3d> vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const LatticeFaces faces = facesOfLattice(
      {{{{0, 1}, {0.1, 0.1}, caps}, {{0, 2}, {0.2, 0.1}, caps}, {{2, 2}, {0.1, 0.1}, caps}},
       {{1, 0.3}},
       false,
       ""},
      vertices, "lattice");
  // Two beams, the third has no length; three balls, of the largest radius each.
  EXPECT_EQ(faces.points.size(), 2U * 34 + 3 * 162);
  EXPECT_EQ(faces.triangles.size(), 3U * (2 * 64 + 3 * 320));
  double max = 0;
  for (const Vec3d& p : faces.points)
    max = std::max(max, p[0]);
  EXPECT_NEAR(max, 1.3, 0.3 * 0.02);
}

TEST(BeamLattice, InvalidOnesAreCounted) {
  const std::array<BeamCap, 2> caps = {BeamCap::Butt, BeamCap::Butt};
  const LatticeFaces faces = facesOfLattice({{{{0, 2}, {1, 1}, caps},
                                              {{0, UINT32_MAX}, {1, 1}, caps},
                                              {{0, 1}, {0, 1}, caps},
                                              {{0, 1}, {1, NAN}, caps},
                                              {{0, 1}, {1, INFINITY}, caps}},
                                             {{2, 1}, {0, -1}},
                                             false,
                                             ""},
                                            kVertices, "lattice");
  EXPECT_EQ(faces.invalid, 7U);
  EXPECT_TRUE(faces.points.empty() && faces.triangles.empty());
}

TEST(BeamLattice, MoreThanMemoryHolds) {
#ifdef TETVDB_SANITIZED
  GTEST_SKIP() << "the sanitizers' shadow is beyond any limit";
#endif
  // 3 GB of triangles, with 2 GB of addresses.
  const std::size_t count = 200000;
  const BeamLattice lattice{{}, std::vector<LatticeBall>(count, {0, 1}), false, ""};
  const std::vector<Vec3d> vertices(count);
  rlimit before;
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  const rlimit less{std::min<rlim_t>(rlim_t(2) << 30, before.rlim_max), before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_AS, &less), 0);
  EXPECT_THROW(facesOfLattice(lattice, vertices, "lattice"), Error);
  setrlimit(RLIMIT_AS, &before);
}

} // namespace
} // namespace tetvdb
