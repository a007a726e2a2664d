// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "PhilippB.h"
#include "tetvdb/geometry/Ownership.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace {

using namespace tetvdb;
using Exact = PhilippB<Int128>;

Exact::Point point() {
  const auto c = rc::gen::inRange<long long>(-40, 41);
  return {*c, *c, *c};
}
std::array<Exact::Point, 4> tet() {
  return {point(), point(), point(), point()};
}

Int128 volume(const std::array<Exact::Point, 4>& t) {
  std::array<Exact::Point, 3> e;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      e[i][k] = t[i + 1][k] - t[0][k];
  return Exact::determinant(e[0], e[1], e[2]);
}

// Weights of p with respect to the tet: sums of determinants written out by Cramer's rule, apart
// from the paper's. p is in the interior iff all four have the sign of the volume.
bool interior(const std::array<Exact::Point, 4>& t, const Exact::Point& p) {
  const int sign = signOf(volume(t));
  if (sign == 0)
    return false;
  for (std::size_t i = 0; i < 4; ++i) {
    auto replaced = t;
    replaced[i] = p;
    if (signOf(volume(replaced)) != sign)
      return false;
  }
  return true;
}

// A tet with volume and a lattice point in its interior: a mean with positive weights.
std::pair<std::array<Exact::Point, 4>, Exact::Point> tetAround() {
  auto t = tet();
  // Any four points are bent into a tet.
  for (std::size_t k = 0; k < 3; ++k)
    t[k + 1][k] += 200;
  Exact::Point p{};
  Int128 sum = 0;
  for (auto& v : t) {
    const Int128 weight = *rc::gen::element<long long>(1, 2, 3, 7, 50);
    for (std::size_t k = 0; k < 3; ++k)
      p[k] += weight * v[k];
    sum += weight;
  }
  // Scaled by the sum of the weights, the mean is a lattice point.
  for (auto& v : t)
    for (auto& c : v)
      c *= sum;
  return {t, p};
}

LatticePoint latticePoint(const Exact::Point& p) {
  const auto units = static_cast<double>(kUnitsPerVoxel);
  return {static_cast<double>(p[0]) * units, static_cast<double>(p[1]) * units,
          static_cast<double>(p[2]) * units};
}

bool owns(const std::array<Exact::Point, 4>& t, const Exact::Point& p) {
  return ownsVoxel({latticePoint(t[0]), latticePoint(t[1]), latticePoint(t[2]), latticePoint(t[3])},
                   {static_cast<int>(p[0]), static_cast<int>(p[1]), static_cast<int>(p[2])});
}

// Lemma 1.1: exchanging two vertices turns the sign of the volume.
RC_GTEST_PROP(PhilippBTest, Lemma11TwoTypesOfTetsHaveOppositeVolumes, ()) {
  const auto t = tet();
  const auto i = *rc::gen::element<std::size_t>(0, 1, 2, 3);
  const auto j = (i + *rc::gen::element<std::size_t>(1, 2, 3)) % 4;
  auto other = t;
  std::swap(other[i], other[j]);
  RC_ASSERT(volume(t) == -volume(other));
}

// Lemma 1.2: a point in the interior has the signs + - + - or - + - +.
RC_GTEST_PROP(PhilippBTest, Lemma12InteriorPointsHaveAlternatingSigns, ()) {
  const auto [t, p] = tetAround();
  RC_ASSERT(Exact::inside(t, p));
}

// Lemma 2.1: with alternating signs, the plane through P and two vertices parts the other two.
RC_GTEST_PROP(PhilippBTest, Lemma21PlanesThroughPPartTheOtherTwo, ()) {
  const auto [t, p] = tetAround();
  std::array<Exact::Point, 4> to;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      to[i][k] = t[i][k] - p[k];
  constexpr std::size_t pairs[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2},
                                       {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};
  for (const auto& q : pairs)
    RC_ASSERT(signOf(Exact::determinant(to[q[0]], to[q[1]], to[q[2]])) *
                  signOf(Exact::determinant(to[q[0]], to[q[1]], to[q[3]])) ==
              -1);
}

// Lemma 2.2, in the form that holds: if P is not in the interior, some plane through P and two
// vertices does not part the other two strictly.
RC_GTEST_PROP(PhilippBTest, Lemma22OutsideSomePlaneDoesNotPart, ()) {
  const auto t = tet();
  const auto p = point();
  RC_PRE(volume(t) != 0 && !interior(t, p));
  std::array<Exact::Point, 4> to;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      to[i][k] = t[i][k] - p[k];
  bool all = true;
  constexpr std::size_t pairs[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2},
                                       {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};
  for (const auto& q : pairs)
    all = all && signOf(Exact::determinant(to[q[0]], to[q[1]], to[q[2]])) *
                         signOf(Exact::determinant(to[q[0]], to[q[1]], to[q[3]])) ==
                     -1;
  RC_ASSERT(!all);
}

// Theorem 1: inside if and only if the signs alternate.
RC_GTEST_PROP(PhilippBTest, Theorem1, ()) {
  const auto t = tet();
  const auto p = point();
  RC_ASSERT(Exact::inside(t, p) == interior(t, p));
}

// Off ties the paper's test and the ownership rule agree; in the interior always.
RC_GTEST_PROP(PhilippBTest, AgreesWithOwnershipOffTies, ()) {
  const auto t = tet();
  const auto p = point();
  bool tie = false;
  for (Int128 d : Exact::determinants(t, p))
    tie = tie || d == 0;
  if (!tie)
    RC_ASSERT(Exact::inside(t, p) == owns(t, p));
  if (Exact::inside(t, p))
    RC_ASSERT(owns(t, p));
}

// On ties it loses: of a lattice-aligned mesh with cells of three voxels not one centre survives,
// since each lies on a face of its Kuhn tets, while the ownership rule gives each to one tet.
TEST(PhilippBTest, LosesEveryCentreOnASharedFace) {
  const TetMesh mesh = meshes::scaled(meshes::kuhnGrid(2, 2, 2), 3);
  int paper = 0, owned = 0;
  for (long long x = 0; x < 6; ++x)
    for (long long y = 0; y < 6; ++y)
      for (long long z = 0; z < 6; ++z)
        for (std::size_t i = 0; i < mesh.tetCount(); ++i) {
          std::array<Exact::Point, 4> t;
          for (std::size_t k = 0; k < 4; ++k)
            for (std::size_t c = 0; c < 3; ++c)
              t[k][c] = static_cast<long long>(mesh.points[mesh.tets[4 * i + k]][c]);
          paper += Exact::inside(t, {x, y, z});
          owned += owns(t, {x, y, z});
        }
  EXPECT_EQ(paper, 0);
  EXPECT_EQ(owned, 6 * 6 * 6);
}

TEST(PhilippBTest, DoublesDoAsThePaperRunsThem) {
  const std::array<PhilippB<double>::Point, 4> t{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  EXPECT_TRUE(PhilippB<double>::inside(t, {0.1, 0.2, 0.3}));
  EXPECT_FALSE(PhilippB<double>::inside(t, {0.5, 0.5, 0.5}));
  EXPECT_FALSE(PhilippB<double>::inside(t, {0.25, 0.25, 0}));
}

} // namespace
