// SPDX-License-Identifier: Apache-2.0
#include "tetrahedralize/TetMeshes.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/complex/InsertPoint.h"

#include <gtest/gtest.h>
#include <random>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = TetComplex::kNone;
constexpr double kCube = 1 << 20;

TetComplex mesh() {
  return cubeMesh(4, kCube, 0.2, ballAt({2 * kCube, 2 * kCube, 2 * kCube}, 1.4 * kCube));
}

// Six times the volume within the tracked faces.
Int128 enclosed(const TetComplex& complex) {
  const TrackedFaces surface = trackedFaces(complex);
  Int128 sum = 0;
  for (std::size_t f = 0; f < surface.faces.size(); ++f) {
    Int128 x[3][3];
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        x[i][axis] = static_cast<std::int64_t>(surface.points[surface.faces[f][i]][axis]);
    sum += surface.chains[f] * (x[0][0] * (x[1][1] * x[2][2] - x[1][2] * x[2][1]) +
                                x[0][1] * (x[1][2] * x[2][0] - x[1][0] * x[2][2]) +
                                x[0][2] * (x[1][0] * x[2][1] - x[1][1] * x[2][0]));
  }
  return sum;
}

// Rounded to the lattice, hence off an edge or a face by up to a unit.
Vec3d mean(const TetComplex& complex, const std::vector<std::uint32_t>& points) {
  Vec3d sum{0, 0, 0};
  for (const std::uint32_t p : points)
    sum = plus(sum, complex.at(p));
  return roundToLattice(times(sum, 1.0 / double(points.size())));
}

void expectSurface(const TetComplex& complex, std::size_t faces, long euler) {
  const TrackedFaces surface = trackedFaces(complex);
  EXPECT_EQ(surface.faces.size(), faces);
  EXPECT_EQ(eulerNumber(surface), euler);
  expectClosed(surface);
}

TEST(PointInsertion, IntoAFaceMakesSixAndCutsTheSurface) {
  TetComplex complex = mesh();
  const Int128 volume = volumeOf(complex);
  const double inside = static_cast<double>(enclosed(complex));
  const long euler = eulerNumber(trackedFaces(complex));
  PointInsertion insert(complex);
  int cuts = 0, surfaceCuts = 0;
  std::vector<std::uint32_t> star;
  for (std::uint32_t t = 0; t < 384; t += 5)
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      const TetComplex::Tet before = complex.tets[t];
      if (before.neighbours[localFace] == TetComplex::kOutside)
        continue;
      const FaceKey key = keyOfFace(before.corners, localFace);
      const std::size_t tets = complex.tetCount(), faces = trackedFaces(complex).faces.size();
      const std::uint32_t made =
          insert.intoFace(t, localFace, mean(complex, {key[0], key[1], key[2]}));
      ASSERT_NE(made, kNone);
      EXPECT_EQ(complex.tetCount(), tets + 4);
      EXPECT_EQ(trackedFaces(complex).faces.size(), faces + (before.tracked[localFace] ? 2u : 0u));
      complex.star(made, star);
      EXPECT_EQ(star.size(), 6u);
      ++cuts;
      surfaceCuts += before.tracked[localFace] ? 1 : 0;
      break;
    }
  complex.verify();
  EXPECT_GT(cuts, 70);
  EXPECT_GT(surfaceCuts, 5);
  EXPECT_TRUE(volumeOf(complex) == volume);
  // Rounding moves points of the surface by a unit.
  EXPECT_NEAR(static_cast<double>(enclosed(complex)) / inside, 1, 1e-5);
  expectSurface(complex, trackedFaces(complex).faces.size(), euler);
}

TEST(PointInsertion, IntoAnEdgeHalvesItsTets) {
  TetComplex complex = mesh();
  const Int128 volume = volumeOf(complex);
  const double inside = static_cast<double>(enclosed(complex));
  const long euler = eulerNumber(trackedFaces(complex));
  PointInsertion insert(complex);
  std::mt19937_64 random(1);
  std::vector<std::uint32_t> tets, ring;
  int cuts = 0, refused = 0;
  for (int i = 0; i < 400; ++i) {
    const auto t = static_cast<std::uint32_t>(random() % complex.tets.size());
    const auto a = complex.tets[t].corners[random() % 4], b = complex.tets[t].corners[random() % 4];
    if (a == b)
      continue;
    const bool closed = complex.ring(a, b, tets, ring);
    int tracked = 0;
    for (const std::uint32_t around : tets)
      for (unsigned localFace = 0; localFace < 4; ++localFace) {
        const std::uint32_t opposite = complex.tets[around].corners[localFace];
        tracked +=
            opposite != a && opposite != b && complex.tets[around].tracked[localFace] ? 1 : 0;
      }
    const std::size_t before = complex.tetCount(), faces = trackedFaces(complex).faces.size();
    const std::uint32_t made = insert.intoEdge(a, b, mean(complex, {a, b}));
    if (!closed) { // on the box's sides
      EXPECT_EQ(made, kNone);
      EXPECT_EQ(complex.tetCount(), before);
      ++refused;
      continue;
    }
    if (made == kNone) // thin tets, by now
      continue;
    ++cuts;
    EXPECT_EQ(complex.tetCount(), before + ring.size());
    EXPECT_EQ(complex.tetAtEdge(a, b), kNone);
    // Each face at the edge was met from both its sides.
    EXPECT_EQ(trackedFaces(complex).faces.size(), faces + static_cast<std::size_t>(tracked / 2));
  }
  complex.verify();
  EXPECT_GT(cuts, 200);
  EXPECT_GT(refused, 5);
  EXPECT_TRUE(volumeOf(complex) == volume);
  EXPECT_NEAR(static_cast<double>(enclosed(complex)) / inside, 1, 1e-5);
  expectSurface(complex, trackedFaces(complex).faces.size(), euler);
}

TEST(PointInsertion, RefusesWhatWouldTurnTetsOver) {
  TetComplex complex = mesh();
  std::string before;
  for (const auto& tet : complex.tets)
    before.append(reinterpret_cast<const char*>(&tet.corners), sizeof(tet.corners));
  const std::size_t points = complex.points.size();
  PointInsertion insert(complex);
  const std::uint32_t t = 200;
  const auto corners = complex.tets[t].corners;
  // On a corner, and beyond a face.
  const FaceKey face = keyOfFace(corners, 0);
  const Vec3d beyond =
      plus(complex.at(face[0]), minus(complex.at(face[0]), complex.at(corners[0])));
  EXPECT_EQ(insert.intoFace(t, 0, complex.at(face[0])), kNone);
  EXPECT_EQ(insert.intoFace(t, 0, beyond), kNone);
  EXPECT_EQ(insert.intoEdge(corners[0], corners[1], complex.at(corners[1])), kNone);
  EXPECT_EQ(insert.intoEdge(corners[0], corners[1], plus(complex.at(corners[0]), {0, 9e9, 0})),
            kNone);
  EXPECT_EQ(insert.intoEdge(0, static_cast<std::uint32_t>(points - 1), {0, 0, 0}), kNone);
  EXPECT_EQ(complex.points.size(), points);
  std::string after;
  for (const auto& tet : complex.tets)
    after.append(reinterpret_cast<const char*>(&tet.corners), sizeof(tet.corners));
  EXPECT_EQ(after, before);
  complex.verify();
}

} // namespace
} // namespace tetvdb
