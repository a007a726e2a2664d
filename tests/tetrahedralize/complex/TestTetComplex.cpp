// SPDX-License-Identifier: Apache-2.0
#include "tetrahedralize/TetMeshes.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace tetvdb {
namespace {

TetComplex perturbedBall(std::uint64_t seed) {
  return cubeMesh(6, 1000, 0.2, ballAt({3000, 3000, 3000}, 2100), seed);
}

// What the neighbours must be, from the corners alone.
void expectConnected(const TetComplex& complex) {
  std::map<FaceKey, std::vector<std::uint32_t>> tetsOfFace;
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t)
    if (complex.tets[t].exists())
      for (unsigned localFace = 0; localFace < 4; ++localFace)
        tetsOfFace[keyOfFace(complex.tets[t].corners, localFace)].push_back(t);
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t)
    if (complex.tets[t].exists())
      for (unsigned localFace = 0; localFace < 4; ++localFace) {
        const auto& both = tetsOfFace[keyOfFace(complex.tets[t].corners, localFace)];
        ASSERT_LE(both.size(), 2u);
        const std::uint32_t expected = both.size() == 1 ? TetComplex::kOutside
                                       : both[0] == t   ? both[1]
                                                        : both[0];
        EXPECT_EQ(complex.tets[t].neighbours[localFace], expected);
      }
}

std::vector<std::uint32_t> tetsWith(const TetComplex& complex,
                                    const std::vector<std::uint32_t>& points) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t)
    if (complex.tets[t].exists() && std::all_of(points.begin(), points.end(), [&](std::uint32_t p) {
          return complex.tets[t].cornerOf(p) < 4;
        }))
      result.push_back(t);
  return result;
}

// A face between two tets gives way to the edge between their tips. False where that cannot be.
bool flipFace(TetComplex& complex, std::uint32_t t, unsigned localFace) {
  const TetComplex::Tet tet = complex.tets[t];
  const std::uint32_t other = tet.neighbours[localFace];
  if (other == TetComplex::kOutside || tet.tracked[localFace])
    return false;
  const TetComplex::Tet beyond = complex.tets[other];
  const std::uint32_t top = tet.corners[localFace],
                      bottom = beyond.corners[complex.localFaceOf(other, t)];
  std::vector<TetComplex::NewTet> fresh;
  for (unsigned k = 0; k < 3; ++k) {
    // Seen from outside of tet, a, b, c turn counter-clockwise; bottom is on that side.
    const std::uint32_t a = tet.corners[kFaceCorners[localFace][k]];
    const std::uint32_t b = tet.corners[kFaceCorners[localFace][(k + 1) % 3]];
    TetComplex::NewTet one;
    one.corners = {a, b, bottom, top};
    if (!complex.isPositive(one.corners))
      std::swap(one.corners[0], one.corners[1]);
    fresh.push_back(one);
  }
  // All of them lie on the same side of the new edge only if they turn about it the same way.
  Int128 volume = 0;
  TetComplex alone;
  alone.points = complex.points;
  for (const auto& one : fresh) {
    if (!complex.isPositive(one.corners))
      return false;
    TetComplex::Tet newTet{};
    newTet.corners = one.corners;
    alone.tets.push_back(newTet);
  }
  volume = volumeOf(alone);
  alone.tets = {tet, beyond};
  if (volume != volumeOf(alone))
    return false;
  complex.replace({t, other}, fresh);
  return true;
}

TEST(TetComplex, FacesFlipAndTheRestStays) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    TetComplex complex = perturbedBall(seed);
    std::mt19937_64 random(seed);
    const Int128 volume = volumeOf(complex);
    const auto before = trackedFaces(complex);
    std::size_t flips = 0;
    for (int i = 0; i < 300; ++i) {
      const auto t = static_cast<std::uint32_t>(random() % complex.tets.size());
      if (complex.tets[t].exists())
        flips += flipFace(complex, t, static_cast<unsigned>(random() % 4));
    }
    EXPECT_GT(flips, 20u);
    ASSERT_NO_THROW(complex.verify());
    expectConnected(complex);
    EXPECT_TRUE(volumeOf(complex) == volume);
    const auto after = trackedFaces(complex);
    EXPECT_EQ(after.faces.size(), before.faces.size());
    expectClosed(after);
  }
}

TEST(TetComplex, StarAndRingAreWhatHasThePointAndTheEdge) {
  TetComplex complex = perturbedBall(3);
  std::vector<std::uint32_t> star, around, ringPoints;
  for (std::uint32_t p = 0; p < complex.points.size(); p += 5) {
    complex.star(p, star);
    std::sort(star.begin(), star.end());
    EXPECT_EQ(star, tetsWith(complex, {p}));
    for (const std::uint32_t q : complex.tets[star[0]].corners) {
      if (q == p)
        continue;
      const bool closed = complex.ring(p, q, around, ringPoints);
      if (!complex.points[p].fixed || !complex.points[q].fixed) {
        ASSERT_TRUE(closed);
      }
      if (!closed)
        continue;
      ASSERT_EQ(around.size(), ringPoints.size());
      for (std::size_t i = 0; i < around.size(); ++i) {
        const std::uint32_t r = ringPoints[i], s = ringPoints[(i + 1) % around.size()];
        EXPECT_TRUE(complex.isPositive({p, q, r, s}));
        EXPECT_EQ(tetsWith(complex, {p, q, r, s}), std::vector<std::uint32_t>{around[i]});
      }
      std::sort(around.begin(), around.end());
      EXPECT_EQ(around, tetsWith(complex, {p, q}));
    }
  }
  // Opposite corners of the box are not joined otherwise than along the diagonals.
  EXPECT_EQ(complex.tetAtEdge(0, 6), TetComplex::kNone);
  EXPECT_FALSE(complex.ring(0, 6, around, ringPoints));
  EXPECT_TRUE(around.empty());
}

// Any edge collapses whose tets stay positive, whatever that does to the surface: chains must add
// up so that windings stay what they were.
TEST(TetComplex, CollapseKeepsWindings) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    TetComplex complex = perturbedBall(seed);
    std::mt19937_64 random(seed);
    const Int128 volume = volumeOf(complex);
    std::size_t collapses = 0;
    std::vector<std::uint32_t> star;
    for (int i = 0; i < 600; ++i) {
      const auto from = static_cast<std::uint32_t>(random() % complex.points.size());
      if (!complex.points[from].exists() || complex.points[from].fixed)
        continue;
      complex.star(from, star);
      const std::uint32_t to = complex.tets[star[random() % star.size()]].corners[random() % 4];
      bool may = to != from;
      for (const std::uint32_t t : star) {
        auto corners = complex.tets[t].corners;
        std::replace(corners.begin(), corners.end(), from, to);
        may = may && (complex.tets[t].cornerOf(to) < 4 || complex.isPositive(corners));
      }
      if (!may)
        continue;
      complex.collapse(from, to, star);
      ++collapses;
      ASSERT_FALSE(complex.points[from].exists());
      ASSERT_NO_THROW(complex.verify());
    }
    EXPECT_GT(collapses, 40u);
    expectConnected(complex);
    EXPECT_TRUE(volumeOf(complex) == volume);
    expectClosed(trackedFaces(complex), true);
  }
}

TEST(TetComplex, VerifySeesWhatIsWrong) {
  const TetComplex good = perturbedBall(1);
  ASSERT_NO_THROW(good.verify());
  TetComplex bad = good;
  std::swap(bad.tets[7].corners[0], bad.tets[7].corners[1]);
  EXPECT_THROW(bad.verify(), std::logic_error);
  bad = good;
  bad.tets[7].chains[1] += 1;
  EXPECT_THROW(bad.verify(), std::logic_error);
  bad = good;
  bad.points[bad.tets[7].corners[2]].tet = 900;
  EXPECT_THROW(bad.verify(), std::logic_error);
}

} // namespace
} // namespace tetvdb
