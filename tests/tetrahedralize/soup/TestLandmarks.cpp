// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "TriangleMeshes.h"
#include "tetvdb/tetrahedralize/soup/Landmarks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

namespace tetvdb {
namespace {

using Face = Landmarks::Face;

Envelope envelopeOf(const TriangleMesh& mesh, double epsilon) {
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3)
    faces.push_back({mesh.triangles[i], mesh.triangles[i + 1], mesh.triangles[i + 2]});
  return Envelope(mesh.points, faces, epsilon);
}

TEST(Landmarks, AreCornersAndPointsOfSharpEdges) {
  const Envelope cube = envelopeOf(meshes::box(), 0.1);
  // Twelve edges in ten intervals each; the sides' diagonals are flat.
  EXPECT_EQ(Landmarks(cube, 0.1001).size(), 8u + 12 * 9);
  EXPECT_EQ(Landmarks(cube, 2).size(), 8u);
  const Envelope fine = envelopeOf(meshes::box({0, 0, 0}, {1, 1, 1}, 4), 0.1);
  EXPECT_EQ(Landmarks(fine, 0.25001).size(), 6u * 16 + 2);
  // A boundary edge is sharp.
  const Envelope square = envelopeOf(meshes::sheet(1), 0.1);
  EXPECT_GT(Landmarks(square, 0.01).size(), 200u);
  EXPECT_EQ(Landmarks(Envelope({}, {}, 1), 1).size(), 0u);
}

TEST(Landmarks, MorePointsCanBeKept) {
  constexpr double kRadius = 0.1;
  const Envelope cube = envelopeOf(meshes::box(), kRadius);
  const Vec3d inMidSide{0.5, 0.5, 1};
  const Landmarks without(cube, 2), with(cube, 2, {inMidSide});
  EXPECT_EQ(with.size(), without.size() + 1);
  const std::vector<Face> before{{{{0.4, 0.4, 1}, {0.6, 0.4, 1}, {0.5, 0.6, 1}}}};
  const auto lower = [](double by) {
    return std::vector<Face>{{{{0.4, 0.4, 1 - by}, {0.6, 0.4, 1 - by}, {0.5, 0.6, 1 - by}}}};
  };
  const Landmarks near(cube, kRadius, {inMidSide});
  EXPECT_TRUE(near.keeps(before, lower(0.97 * kRadius)));
  EXPECT_FALSE(near.keeps(before, lower(0.99 * kRadius)));
  EXPECT_TRUE(Landmarks(cube, kRadius).keeps(before, lower(0.99 * kRadius)));
}

TEST(Landmarks, ACornerIsKeptToTheCubesNotToWhatBecameOfIt) {
  constexpr double kRadius = 0.1;
  const Envelope cube = envelopeOf(meshes::box(), kRadius);
  const Landmarks landmarks(cube, kRadius);
  // The three sides at the corner (1, 1, 1), whose point moves inward in small steps.
  const auto at = [](double in) {
    const Vec3d p{1 - in, 1 - in, 1 - in};
    return std::vector<Face>{
        {{p, {1, 0, 1}, {1, 1, 0}}}, {{p, {1, 1, 0}, {0, 1, 1}}}, {{p, {0, 1, 1}, {1, 0, 1}}}};
  };
  constexpr double kStep = 0.001;
  double in = 0;
  while (in < 1 && landmarks.keeps(at(in), at(in + kStep)))
    in += kStep;
  // By hand: the nearest of the faces is their common point.
  EXPECT_NEAR(in * std::sqrt(3.0), Landmarks::kShare * kRadius, 2 * kStep);
  // Back is always allowed, even from too far away.
  EXPECT_TRUE(landmarks.keeps(at(in), at(0)));
  EXPECT_TRUE(landmarks.keeps(at(in + 0.002), at(in + 0.001)));
  // Where nothing was near, nothing is lost.
  EXPECT_TRUE(landmarks.keeps(at(0.3), at(0.5)));
}

TEST(Landmarks, TheSameAsLookingAtEveryOne) {
  constexpr double kRadius = 0.3;
  const TriangleMesh mesh = meshes::moved(meshes::sheet(40), [](const Vec3d& p) {
    const auto rounded = [](double x) { return std::round(x * 0x1p20) * 0x1p-20; };
    return Vec3d{rounded(3 * p[0]), rounded(3 * p[1]), rounded(0.2 * std::sin(9 * p[0]) * p[1])};
  });
  const Landmarks landmarks(envelopeOf(mesh, kRadius), kRadius);
  EXPECT_EQ(landmarks.size(), mesh.points.size()); // edges are shorter than the radius
  // Faces that are points: distances need no more than Pythagoras.
  meshes::Random random(1);
  const auto squareTo = [](const Vec3d& p, const std::vector<Face>& faces) {
    double minValue = 1e9;
    for (const Face& face : faces) {
      double square = 0;
      for (std::size_t axis = 0; axis < 3; ++axis)
        square += (p[axis] - face[0][axis]) * (p[axis] - face[0][axis]);
      minValue = std::min(minValue, square);
    }
    return minValue;
  };
  std::array<int, 2> answers{0, 0};
  for (int i = 0; i < 2000; ++i) {
    std::vector<Face> before, after;
    const double move = 0.03 * random.unit() * random.unit();
    for (int k = 0; k < 4; ++k) {
      const Vec3d p{random.between(1, 1.4), random.between(1, 1.4), random.between(-0.4, 0.4)};
      const Vec3d q{p[0] + move * random.unit(), p[1] - move * random.unit(), p[2]};
      before.push_back({p, p, p});
      after.push_back({q, q, q});
    }
    bool all = true;
    for (const Vec3d& p : mesh.points) {
      const double was = std::sqrt(squareTo(p, before)), now = std::sqrt(squareTo(p, after));
      all = all && (was > kRadius || now <= was || now <= Landmarks::kShare * kRadius);
    }
    EXPECT_EQ(landmarks.keeps(before, after), all);
    ++answers[all];
  }
  EXPECT_GT(answers[0], 200);
  EXPECT_GT(answers[1], 200);
}

} // namespace
} // namespace tetvdb
