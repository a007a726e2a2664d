// SPDX-License-Identifier: Apache-2.0
#include "tetrahedralize/TetMeshes.h"
#include "tetvdb/tetrahedralize/complex/EdgeSizes.h"
#include "tetvdb/tetrahedralize/complex/SplitEdges.h"
#include "tetvdb/tetrahedralize/complex/TetEnergy.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <set>
#include <vector>

namespace tetvdb {
namespace {

constexpr double kStep = 1e6;
constexpr double kNoLimit = std::numeric_limits<double>::infinity();
const double kQuantum = std::exp2(1.0 / 12); // two neighbouring sizes

double distance(const Vec3d& a, const Vec3d& b) {
  return std::sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                   (a[2] - b[2]) * (a[2] - b[2]));
}

TetComplex ballInBox() {
  TetComplex complex =
      cubeMesh(10, kStep, 0.15, ballAt({5 * kStep, 5 * kStep, 5 * kStep}, 3.4 * kStep));
  for (TetComplex::Tet& tet : complex.tets) { // outside counts less
    const auto& a = complex.at(tet.corners[0]);
    Vec3d centre = a;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      centre[axis] = 0;
      for (const std::uint32_t corner : tet.corners)
        centre[axis] += complex.at(corner)[axis] / 4;
    }
    tet.weight = distance(centre, {5 * kStep, 5 * kStep, 5 * kStep}) < 3.4 * kStep ? 1 : 0.1f;
  }
  return complex;
}

TEST(EdgeSizes, StepsOfATwelfthOfAnOctave) {
  const EdgeSizes sizes(100);
  EXPECT_EQ(sizes.longest(), 100);
  EXPECT_EQ(sizes.finenessOf(1000), 0);
  EXPECT_EQ(sizes.finenessOf(50), 12);
  EXPECT_EQ(sizes.finenessOf(1e-30), 255);
  for (double length = 99; length > 1e-3; length *= 0.97) {
    TetComplex::Point point;
    point.fineness = sizes.finenessOf(length);
    EXPECT_LE(sizes.at(point), length * (1 + 1e-12));
    EXPECT_GE(sizes.at(point), length / kQuantum * (1 - 1e-12));
  }
}

TEST(EdgeSizes, FollowTheSurfaceAndGrowFromThere) {
  TetComplex complex = ballInBox();
  constexpr double kShare = 0.8, kGrowth = 0.3;
  const EdgeSizes sizes(100 * kStep);
  sizes.followSurface(complex, kShare, kGrowth, kNoLimit);
  std::map<std::uint32_t, std::set<std::uint32_t>> onSurface; // neighbours along it
  for (const auto& face : trackedFaces(complex).faces)
    for (std::size_t i = 0; i < 3; ++i)
      onSurface[face[i]].insert({face[(i + 1) % 3], face[(i + 2) % 3]});
  std::map<std::uint32_t, double> asked;
  for (const auto& [p, others] : onSurface) {
    double sum = 0;
    for (const std::uint32_t q : others)
      sum += distance(complex.at(p), complex.at(q));
    asked[p] = kShare * sum / static_cast<double>(others.size());
  }
  std::set<std::uint32_t> inside;
  for (const TetComplex::Tet& tet : complex.tets)
    if (tet.weight == 1)
      for (const std::uint32_t a : tet.corners)
        for (const std::uint32_t b : tet.corners) {
          inside.insert(a);
          EXPECT_LE(sizes.at(complex.points[b]),
                    kQuantum * (sizes.at(complex.points[a]) * (1 + 1e-9) +
                                kGrowth * distance(complex.at(a), complex.at(b))));
        }
  for (std::uint32_t p = 0; p < complex.points.size(); ++p) {
    const double size = sizes.at(complex.points[p]);
    if (inside.count(p) == 0) {
      EXPECT_EQ(size, sizes.longest());
      continue;
    }
    // No smaller than some point of the surface asks for.
    double minValue = std::numeric_limits<double>::infinity();
    for (const auto& [q, length] : asked)
      minValue = std::min(minValue, length + kGrowth * distance(complex.at(p), complex.at(q)));
    EXPECT_GE(size, minValue / kQuantum * (1 - 1e-9));
    if (asked.count(p) != 0) {
      EXPECT_LE(size, asked[p] * (1 + 1e-9));
    }
  }
}

TEST(EdgeSizes, RefineAroundBadTetsAlone) {
  TetComplex complex = ballInBox();
  const EdgeSizes sizes(10 * kStep);
  double worst = 0;
  std::uint32_t bad = 0;
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t)
    if (complex.tets[t].weight == 1 && energyOf(complex, t) > worst) {
      worst = energyOf(complex, t);
      bad = t;
    }
  const auto corners = complex.tets[bad].corners;
  double mean = 0;
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = i + 1; j < 4; ++j)
      mean += distance(complex.at(corners[i]), complex.at(corners[j])) / 6;
  constexpr double kGrowth = 2;
  EXPECT_TRUE(sizes.refine(complex, 0.99999 * worst, 0.5, kGrowth, 0, kNoLimit));
  for (std::uint32_t p = 0; p < complex.points.size(); ++p) {
    double far = std::numeric_limits<double>::infinity();
    for (const std::uint32_t corner : corners)
      far = std::min(far, distance(complex.at(p), complex.at(corner)));
    const double size = sizes.at(complex.points[p]);
    if (far == 0) {
      EXPECT_NEAR(size, 0.5 * mean, 0.5 * mean * (kQuantum - 1));
    } else {
      EXPECT_GE(size, std::min(sizes.longest(), 0.5 * mean + kGrowth * far) / kQuantum);
    }
  }
  // Never below what is asked as the shortest.
  TetComplex other = ballInBox();
  EXPECT_TRUE(sizes.refine(other, 0, 0.01, 2, 0.7 * kStep, kNoLimit));
  for (const TetComplex::Point& point : other.points)
    EXPECT_GE(sizes.at(point), 0.7 * kStep / kQuantum);
}

// The number that a volume filled by regular tets of these edges has, within a factor of two.
TEST(EdgeSizes, NoSmallerThanTheMostTetsAllow) {
  constexpr double kMost = 1000;
  const EdgeSizes sizes(10 * kStep);
  TetComplex complex = ballInBox();
  sizes.followSurface(complex, 0.05, 0.01, kMost);
  double sum = 0, smallest = sizes.longest();
  for (const TetComplex::Tet& tet : complex.tets)
    if (tet.weight == 1) {
      Vec3d edge[3];
      double size = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        size += sizes.at(complex.points[tet.corners[i]]) / 4;
        for (std::size_t axis = 0; i > 0 && axis < 3; ++axis)
          edge[i - 1][axis] = complex.at(tet.corners[i])[axis] - complex.at(tet.corners[0])[axis];
      }
      const double determinant = edge[0][0] * (edge[1][1] * edge[2][2] - edge[1][2] * edge[2][1]) -
                                 edge[0][1] * (edge[1][0] * edge[2][2] - edge[1][2] * edge[2][0]) +
                                 edge[0][2] * (edge[1][0] * edge[2][1] - edge[1][1] * edge[2][0]);
      sum += std::max(1.0, std::abs(determinant) / 6 * 6 * std::sqrt(2.0) / std::pow(size, 3));
      smallest = std::min(smallest, size);
    }
  const auto inside = std::count_if(complex.tets.begin(), complex.tets.end(),
                                    [](const auto& tet) { return tet.weight == 1; });
  EXPECT_LE(sum, std::max(kMost, 1.0 * static_cast<double>(inside)));
  EXPECT_GT(smallest, 0.2 * kStep); // 0.05 of an edge was asked for

  TetComplex other = ballInBox();
  std::vector<std::uint8_t> before;
  for (const TetComplex::Point& point : other.points)
    before.push_back(point.fineness);
  EXPECT_FALSE(sizes.refine(other, 0, 0.05, 0.01, 0, kMost));
  for (std::size_t p = 0; p < before.size(); ++p)
    ASSERT_EQ(other.points[p].fineness, before[p]);
}

// The size of a midpoint is the mean of its ends', not their geometric mean: sizes that grow along
// an edge stay as they grow.
TEST(SplitEdges, SizeOfAMidpointIsTheMean) {
  TetComplex complex = cubeMesh(4, kStep, 0, ballAt({0, 0, 0}, 0));
  const EdgeSizes sizes(0.8 * kStep);
  for (TetComplex::Point& point : complex.points)
    point.fineness = 0;
  const std::uint32_t midpoint = (2 * 5 + 2) * 5 + 2;
  complex.points[midpoint].fineness = 48; // a sixteenth
  const std::size_t count = complex.points.size();
  ASSERT_GT(splitEdges(complex, sizes, 1, 1e9), 0u);
  std::size_t between = 0;
  for (std::size_t p = count; p < complex.points.size(); ++p) {
    const double size = sizes.at(complex.points[p]);
    between += size < 0.8 * kStep;
    EXPECT_GE(size, 0.8 * kStep * (1 + 1. / 16) / 2 / kQuantum);
  }
  EXPECT_GT(between, 0u);
}

// Flat cells: halving one of the short edges makes tets flatter still.
TEST(SplitEdges, NotWhereTetsGetMuchWorse) {
  const auto flatMesh = [] {
    TetComplex complex = cubeMesh(4, kStep, 0, ballAt({0, 0, 0}, 0));
    for (TetComplex::Point& point : complex.points) {
      point.at[2] /= 16;
      point.fineness = 0;
    }
    const std::uint32_t midpoint = (2 * 5 + 2) * 5 + 2; // and the one above
    complex.points[midpoint].fineness = complex.points[midpoint + 25].fineness = 255;
    return complex;
  };
  const EdgeSizes sizes(1000 * kStep);
  TetComplex strict = flatMesh(), free = flatMesh();
  const double worst = energyOf(strict, 0);
  EXPECT_EQ(splitEdges(strict, sizes, 1, 1.2 * worst), 0u);
  EXPECT_EQ(splitEdges(free, sizes, 1, 10 * worst), 1u);
  ASSERT_NO_THROW(free.verify());
  EXPECT_EQ(free.points.back().fineness, 255);
  // Nor where quality matters less.
  TetComplex light = flatMesh();
  for (TetComplex::Tet& tet : light.tets)
    tet.weight = 0.5;
  EXPECT_EQ(splitEdges(light, sizes, 1, 10 * worst), 0u);
}

} // namespace
} // namespace tetvdb
