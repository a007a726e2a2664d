// SPDX-License-Identifier: Apache-2.0
#include "tetrahedralize/TetMeshes.h"
#include "tetvdb/tetrahedralize/inside/RegionChains.h"
#include "tetvdb/tetrahedralize/inside/Regions.h"

#include <gtest/gtest.h>
#include <vector>

namespace tetvdb {
namespace {

constexpr double kChainStep = 1e6;

// Two balls that overlap, as inputs of one mesh, with a sheet of no winding between some tets.
struct TwoBalls {
  std::vector<std::uint16_t> inside; // by the mesh's own geometry
  TetComplex complex;

  TwoBalls()
      : complex(cubeMesh(8, kChainStep, 0.1, [this](const Vec3d& p) {
          const Chain a =
              ballAt({3 * kChainStep, 4 * kChainStep, 4 * kChainStep}, 2 * kChainStep)(p);
          const Chain b =
              ballAt({5 * kChainStep, 4 * kChainStep, 4 * kChainStep}, 2 * kChainStep)(p);
          inside.push_back(static_cast<std::uint16_t>(a + 2 * b));
          return a * unitChain(0, 2) + b * unitChain(1, 2);
        })) {
    for (std::uint32_t t = 0; t < 40; ++t) {
      const std::uint32_t next = complex.tets[t].neighbours[2];
      if (next == TetComplex::kOutside)
        continue;
      complex.tets[t].tracked[2] = true;
      complex.tets[next].tracked[complex.localFaceOf(next, t)] = true;
    }
    complex.points[100].onBoundary = true;
  }
};

// Makes a hole of one face in an input; returns the points at it.
std::vector<std::uint32_t> makeHole(TetComplex& complex) {
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t) {
    unsigned localFace = 0;
    while (localFace < 4 && (complex.tets[t].chains[localFace] == 0 ||
                             complex.tets[t].neighbours[localFace] == TetComplex::kOutside))
      ++localFace;
    if (localFace == 4)
      continue;
    const std::uint32_t next = complex.tets[t].neighbours[localFace];
    const unsigned back = complex.localFaceOf(next, t);
    complex.tets[t].tracked[localFace] = complex.tets[next].tracked[back] = false;
    complex.tets[t].chains[localFace] = complex.tets[next].chains[back] = 0;
    std::vector<std::uint32_t> points;
    for (const unsigned corner : kFaceCorners[localFace])
      points.push_back(complex.tets[t].corners[corner]);
    return points;
  }
  return {};
}

TEST(RegionChains, OnlyWhatPartsRegionsIsTracked) {
  for (const Boolean rule :
       {Boolean::Materials, Boolean::Union, Boolean::Difference, Boolean::Intersection})
    for (const bool keepOutside : {false, true}) {
      TwoBalls balls;
      TetComplex& complex = balls.complex;
      ASSERT_TRUE(chainRegions(complex, balls.inside, 2, rule, keepOutside));
      ASSERT_NO_THROW(complex.verify());
      const auto region = [&](std::uint32_t t) { return regionOf(balls.inside[t], 2, rule); };
      std::size_t walls = 0;
      for (std::uint32_t t = 0; t < complex.tets.size(); ++t) {
        const TetComplex::Tet& tet = complex.tets[t];
        EXPECT_EQ(tet.weight < 1, region(t) == kOutsideRegion && !keepOutside);
        for (unsigned localFace = 0; localFace < 4; ++localFace) {
          const std::uint32_t next = tet.neighbours[localFace];
          const std::int32_t other = next == TetComplex::kOutside ? kOutsideRegion : region(next);
          EXPECT_EQ(tet.tracked[localFace], region(t) != other);
          Chain expected = 0; // of region r digit r - 1, sixteen bits each
          if (region(t) != other) {
            expected += region(t) == 1 ? 1 : region(t) == 2 ? 1 << 16 : 0;
            expected -= other == 1 ? 1 : other == 2 ? 1 << 16 : 0;
          }
          EXPECT_EQ(tet.chains[localFace], expected);
          walls += tet.tracked[localFace];
        }
      }
      EXPECT_GT(walls, 50u);
      for (const TetComplex::Point& point : complex.points)
        EXPECT_FALSE(point.onBoundary);
      expectClosed(trackedFaces(complex), rule == Boolean::Materials);
    }
}

TEST(RegionChains, NothingIsChangedWhereInsideEndsAtNoFace) {
  TwoBalls balls;
  TetComplex& complex = balls.complex;
  ASSERT_EQ(makeHole(complex).size(), 3u);
  const TetComplex before = complex;
  EXPECT_FALSE(chainRegions(complex, balls.inside, 2, Boolean::Materials, false));
  for (std::size_t t = 0; t < complex.tets.size(); ++t) {
    EXPECT_EQ(complex.tets[t].chains, before.tets[t].chains);
    EXPECT_EQ(complex.tets[t].tracked, before.tets[t].tracked);
    EXPECT_EQ(complex.tets[t].weight, 1);
  }
}

TEST(RegionChains, TetsAroundAHoleKeepTheirWeight) {
  TwoBalls balls;
  TetComplex& complex = balls.complex;
  std::vector<std::uint32_t> near = makeHole(complex);
  ASSERT_EQ(near.size(), 3u);
  for (TetComplex::Point& point : complex.points)
    point.changed = 0;
  complex.tets[7].weight = 0.5f; // of an earlier time
  weighOutside(complex, balls.inside, 2, Boolean::Materials);
  ASSERT_NO_THROW(complex.verify());
  // Three rings of tets, one point after another.
  std::vector<bool> isNear(complex.tets.size(), false);
  for (int ring = 0; ring < 3; ++ring) {
    std::vector<std::uint32_t> star, next = near;
    for (const std::uint32_t point : near) {
      complex.star(point, star);
      for (const std::uint32_t t : star) {
        isNear[t] = true;
        next.insert(next.end(), complex.tets[t].corners.begin(), complex.tets[t].corners.end());
      }
    }
    near = next;
  }
  std::size_t light = 0, kept = 0;
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t) {
    const bool isOutside = balls.inside[t] == 0;
    EXPECT_EQ(complex.tets[t].weight < 1, isOutside && !isNear[t]);
    light += isOutside && !isNear[t];
    kept += isOutside && isNear[t];
    if (complex.tets[t].weight < 1) {
      for (const std::uint32_t corner : complex.tets[t].corners)
        EXPECT_NE(complex.points[corner].changed, 0);
    }
  }
  EXPECT_GT(light, 100u);
  EXPECT_GT(kept, 20u);
}

} // namespace
} // namespace tetvdb
