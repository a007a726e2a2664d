// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/soup/PerturbSoup.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <cmath>
#include <gtest/gtest.h>
#include <set>

namespace tetvdb {
namespace {

constexpr double kPerturbScale = 0x1p40, kGrain = 1024, kDistance = 0x1p30;

LatticeSoup perturbedSoupOf(const TriangleMesh& mesh) {
  LatticeSoup soup;
  soup.grain = kGrain;
  for (const Vec3d& p : mesh.points)
    soup.points.push_back(roundToGrain(times(p, kPerturbScale), kGrain));
  for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3)
    soup.faces.push_back({mesh.triangles[i], mesh.triangles[i + 1], mesh.triangles[i + 2]});
  Progress quiet;
  tidySoup(soup, quiet);
  return soup;
}

std::vector<Vec3d> cornersOf(const LatticeSoup& soup) {
  std::vector<Vec3d> corners;
  for (const auto& face : soup.faces)
    for (const std::uint32_t point : face)
      corners.push_back(soup.points[point]);
  return corners;
}

TEST(PerturbSoup, MovesEveryPointALittleAndDifferently) {
  const LatticeSoup soup = perturbedSoupOf(meshes::sphere({0, 0, 0}, 1, 12));
  std::set<Vec3d> moves;
  for (const std::uint32_t seed : {1u, 2u}) {
    const LatticeSoup perturbed = perturbedSoup(soup, kDistance, Perturb::Points, seed);
    ASSERT_EQ(perturbed.faces, soup.faces);
    EXPECT_EQ(perturbed.grain, kGrain);
    for (std::size_t p = 0; p < soup.points.size(); ++p) {
      const Vec3d move = minus(perturbed.points[p], soup.points[p]);
      EXPECT_LE(length(move), kDistance);
      EXPECT_EQ(perturbed.points[p], roundToGrain(perturbed.points[p], kGrain));
      EXPECT_TRUE(moves.insert(move).second);
    }
    EXPECT_EQ(perturbedSoup(soup, kDistance, Perturb::Points, seed).points, perturbed.points);
  }
}

TEST(PerturbSoup, MovesClosedComponentsAsAWhole) {
  TriangleMesh mesh = meshes::sphere({0, 0, 0}, 0.3, 6);
  const std::size_t first = mesh.triangleCount();
  meshes::append(mesh, meshes::sphere({1, 0, 0}, 0.3, 6));
  const LatticeSoup soup = perturbedSoupOf(mesh);
  const LatticeSoup perturbed = perturbedSoup(soup, kDistance, Perturb::Components, 3);
  ASSERT_EQ(perturbed.faces.size(), soup.faces.size());
  const std::vector<Vec3d> before = cornersOf(soup), after = cornersOf(perturbed);
  const Vec3d moved = minus(after[0], before[0]), other = minus(after.back(), before.back());
  EXPECT_NE(moved, other);
  EXPECT_GT(length(moved), 0);
  EXPECT_LE(length(moved), kDistance);
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(minus(after[i], before[i]), i < 3 * first ? moved : other);
}

// Two boxes on one another's corner come apart; an open sheet stays where it is.
TEST(PerturbSoup, ComponentsThatMeetInAPointComeApartAndOpenOnesStay) {
  TriangleMesh mesh = meshes::box({0, 0, 0}, {1, 1, 1});
  meshes::append(mesh, meshes::box({1, 1, 1}, {2, 2, 2}));
  const LatticeSoup soup = perturbedSoupOf(mesh);
  ASSERT_EQ(soup.points.size(), 15u);
  EXPECT_EQ(perturbedSoup(soup, kDistance, Perturb::Components, 1).points.size(), 16u);

  const LatticeSoup sheet = perturbedSoupOf(meshes::sheet(3));
  EXPECT_EQ(cornersOf(perturbedSoup(sheet, kDistance, Perturb::Components, 1)), cornersOf(sheet));
}

} // namespace
} // namespace tetvdb
