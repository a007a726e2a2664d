// SPDX-License-Identifier: Apache-2.0
#include "tetrahedralize/TetMeshes.h"
#include "tetvdb/tetrahedralize/complex/TetParts.h"

#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kFew = 300; // tets a part

TetComplex mesh() {
  return cubeMesh(10, 1000, 0.2, ballAt({5000, 5000, 5000}, 3600));
}

// By points, so that it does not depend on the numbers of tets.
std::map<FaceKey, std::pair<Chain, bool>> surfaceOf(const TetComplex& complex) {
  std::map<FaceKey, std::pair<Chain, bool>> result;
  for (const auto& tet : complex.tets)
    if (tet.exists())
      for (unsigned localFace = 0; localFace < 4; ++localFace)
        if (tet.tracked[localFace])
          result[keyOfFace(tet.corners, localFace)] = {std::abs(tet.chains[localFace]), true};
  return result;
}

// Points move and go, at random, but so that tets stay positive.
void disturb(TetParts::Part& part) {
  TetComplex& complex = part.complex;
  std::mt19937_64 random(part.index);
  std::vector<std::uint32_t> star;
  for (std::uint32_t p = 0; p < complex.points.size(); ++p) {
    const auto& point = complex.points[p];
    if (!point.exists() || point.fixed)
      continue;
    complex.star(p, star);
    if (random() % 2 == 0) {
      const Vec3d old = point.at;
      Vec3d moved = old;
      for (double& coordinate : moved)
        coordinate += static_cast<double>(random() % 101) - 50;
      complex.move(p, moved, star);
      for (const std::uint32_t t : star)
        if (!complex.isPositive(complex.tets[t].corners)) {
          complex.move(p, old, star);
          break;
        }
      continue;
    }
    for (const std::uint32_t to : complex.tets[star[0]].corners) {
      bool may = to != p;
      for (const std::uint32_t t : star) {
        const auto& tet = complex.tets[t];
        auto corners = tet.corners;
        std::replace(corners.begin(), corners.end(), p, to);
        for (const bool isTracked : tet.tracked)
          may = may && !isTracked;
        may = may && (tet.cornerOf(to) < 4 || complex.isPositive(corners));
      }
      if (may) {
        complex.collapse(p, to, star);
        break;
      }
    }
  }
}

TEST(TetParts, PartsHaveAllTetsAndShareFixedPoints) {
  for (int round = 0; round < TetParts::kRounds; ++round) {
    TetComplex complex = mesh();
    const std::size_t tets = complex.tetCount(), points = complex.points.size();
    std::vector<int> parts(points, 0);
    std::vector<char> fixed(points, 0), wasFixed(points, 0);
    for (std::size_t p = 0; p < points; ++p)
      wasFixed[p] = complex.points[p].fixed;
    TetParts cut(complex, round, kFew);
    ASSERT_GT(cut.count(), 8u);
    tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    std::size_t inParts = 0;
    Progress progress;
    cut.run(
        [&](TetParts::Part& part) {
          inParts += part.complex.tetCount();
          EXPECT_GE(part.complex.tetCount(), kFew);
          EXPECT_LE(part.complex.tetCount(), 2 * kFew);
          EXPECT_NO_THROW(part.complex.verify());
          for (std::uint32_t p = 0; p < part.pointOfWhole.size(); ++p) {
            ++parts[part.pointOfWhole[p]];
            fixed[part.pointOfWhole[p]] = part.complex.points[p].fixed;
            EXPECT_EQ(part.local(part.pointOfWhole[p]), p);
          }
        },
        progress);
    EXPECT_EQ(inParts, tets);
    for (std::size_t p = 0; p < points; ++p) {
      EXPECT_GE(parts[p], 1);
      EXPECT_EQ(static_cast<bool>(fixed[p]), wasFixed[p] || parts[p] > 1);
    }
  }
}

TEST(TetParts, JoinedAgainTheMeshIsWhatItWas) {
  TetComplex complex = mesh();
  const auto before = surfaceOf(complex);
  const Int128 volume = volumeOf(complex);
  const TetComplex old = complex;
  Progress progress;
  for (int round = -1; round < 4; ++round) {
    TetParts(complex, round, kFew).run([](TetParts::Part&) {}, progress);
    ASSERT_NO_THROW(complex.verify());
    EXPECT_EQ(complex.tetCount(), old.tetCount());
    EXPECT_EQ(surfaceOf(complex), before);
    EXPECT_TRUE(volumeOf(complex) == volume);
    for (std::size_t p = 0; p < complex.points.size(); ++p) {
      EXPECT_EQ(complex.points[p].at, old.points[p].at);
      EXPECT_EQ(complex.points[p].fixed, old.points[p].fixed);
    }
    for (const auto& tet : complex.tets)
      for (const std::uint32_t next : tet.neighbours)
        EXPECT_TRUE(next < complex.tets.size() || next == TetComplex::kOutside);
  }
}

TEST(TetParts, WorkOnPartsIsTheSameForAnyNumberOfThreads) {
  std::vector<TetComplex> results;
  for (const std::size_t threads : {1u, 2u, 8u}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    TetComplex complex = mesh();
    const Int128 volume = volumeOf(complex);
    const auto surface = surfaceOf(complex);
    Progress progress;
    for (int round = 0; round < 4; ++round) {
      const std::size_t tets = complex.tetCount();
      TetParts(complex, round, kFew).run(disturb, progress);
      ASSERT_NO_THROW(complex.verify());
      EXPECT_LT(complex.tetCount(), tets);
      EXPECT_TRUE(volumeOf(complex) == volume);
      EXPECT_EQ(surfaceOf(complex), surface);
    }
    results.push_back(complex);
  }
  for (std::size_t i = 1; i < results.size(); ++i) {
    ASSERT_EQ(results[i].tets.size(), results[0].tets.size());
    for (std::size_t t = 0; t < results[0].tets.size(); ++t) {
      EXPECT_EQ(results[i].tets[t].corners, results[0].tets[t].corners);
      EXPECT_EQ(results[i].tets[t].neighbours, results[0].tets[t].neighbours);
      EXPECT_EQ(results[i].tets[t].chains, results[0].tets[t].chains);
    }
    for (std::size_t p = 0; p < results[0].points.size(); ++p)
      EXPECT_EQ(results[i].points[p].at, results[0].points[p].at);
  }
}

} // namespace
} // namespace tetvdb
