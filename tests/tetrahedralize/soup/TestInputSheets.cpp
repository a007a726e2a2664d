// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/soup/InputSheets.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <utility>

namespace tetvdb {
namespace {

using Face = std::array<std::uint32_t, 3>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Sheets {
  std::vector<Vec3d> points;
  std::vector<Face> faces;

  double distanceTo(const Vec3d& p) const {
    double squared = kInfinity;
    for (const auto& [a, b, c] : faces)
      squared = std::min(
          squared,
          nearestOnTriangle(minus(points[a], p), minus(points[b], p), minus(points[c], p)).squared);
    return std::sqrt(squared);
  }
};

// A sheet of n x n squares over [0, n]^2, of heights up to `height`.
Sheets squares(int n, double height, meshes::Random& random) {
  Sheets sheet;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      sheet.points.push_back({double(i), double(j), height * random.between(-1, 1)});
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const auto a = static_cast<std::uint32_t>(i * (n + 1) + j);
      const auto b = a + static_cast<std::uint32_t>(n + 1);
      sheet.faces.push_back({a, b, b + 1});
      sheet.faces.push_back({a, b + 1, a + 1});
    }
  return sheet;
}

// The tree's triangle nearest to a point.
std::uint32_t nearestTo(const TriangleTree& tree, const Vec3d& p) {
  std::uint32_t nearest = 0;
  tree.visit(p, 1e300, [&](std::uint32_t i, double& limit) {
    if (tree.triangle(i).squaredDistance(p) <= limit) {
      limit = tree.triangle(i).squaredDistance(p);
      nearest = i;
    }
    return false;
  });
  return nearest;
}

InputSheets::Gap gapOf(const Sheets& sheets, const std::array<Vec3d, 3>& at, double most,
                       double enough = 0) {
  const TriangleTree tree(sheets.points, sheets.faces);
  const Vec3d centre = times(plus(plus(at[0], at[1]), at[2]), 1.0 / 3);
  return InputSheets(tree, sheets.faces, sheets.points.size())
      .gap(at[0], at[1], at[2], nearestTo(tree, centre), most, enough);
}

// Samples of the candidate, corners and edges among them.
double largestDistance(const Sheets& sheets, const std::array<Vec3d, 3>& at) {
  constexpr int kSamples = 14;
  double largest = 0;
  for (int i = 0; i <= kSamples; ++i)
    for (int j = 0; i + j <= kSamples; ++j)
      largest = std::max(
          largest,
          sheets.distanceTo(plus(at[0], plus(times(minus(at[1], at[0]), double(i) / kSamples),
                                             times(minus(at[2], at[0]), double(j) / kSamples)))));
  return largest;
}

TEST(InputSheets, ThePlaneBelow) {
  meshes::Random random(1);
  const Sheets plane = squares(8, 0, random);
  const std::array<Vec3d, 3> at{Vec3d{1.1, 1.3, 0.25}, {6.7, 2.2, 0.25}, {3.1, 6.9, 0.25}};
  EXPECT_NEAR(gapOf(plane, at, 1).bound, 0.25, 1e-12);
  EXPECT_NEAR(gapOf(plane, {at[0], at[2], at[1]}, 1).bound, 0.25, 1e-12); // from below
  const InputSheets::Gap far = gapOf(plane, at, 0.2);
  EXPECT_EQ(far.bound, kInfinity);
  EXPECT_TRUE(far.isFar);
  EXPECT_NEAR(far.far[2], 0.25, 1e-12);
  EXPECT_LE(gapOf(plane, at, 1, 0.5).bound, 0.5);
}

TEST(InputSheets, AtTheCornersOfPieces) {
  meshes::Random random(1);
  Sheets roof = squares(4, 0, random);
  for (std::uint32_t j = 0; j <= 4; ++j)
    roof.points[5 * 2 + j][2] = 0.5; // along x = 2
  // Where the ridge crosses the candidate, neither of them has a corner.
  const std::array<Vec3d, 3> at{Vec3d{1.5, 0.6, 0}, {2.5, 0.7, 0}, {2.1, 3.5, 0}};
  EXPECT_NEAR(gapOf(roof, at, 1).bound, 0.5, 1e-12);
}

TEST(InputSheets, BeyondABoundaryNothingIsKnown) {
  meshes::Random random(1);
  Sheets plane = squares(8, 0, random);
  EXPECT_EQ(gapOf(plane, {Vec3d{5.1, 1.3, 0.1}, {9.7, 2.2, 0.1}, {6.1, 6.9, 0.1}}, 1).bound,
            kInfinity);
  const std::array<Vec3d, 3> at{Vec3d{1.1, 1.3, 0.1}, {6.7, 2.2, 0.1}, {3.1, 6.9, 0.1}};
  EXPECT_LT(gapOf(plane, at, 1).bound, 1);
  plane.faces.erase(plane.faces.begin() + 2 * (3 * 8 + 3)); // a hole
  EXPECT_EQ(gapOf(plane, at, 1).bound, kInfinity);
}

TEST(InputSheets, AFoldCoversNothingTwice) {
  // Two triangles on top of one another: a boundary is nowhere over the candidate, which is beyond
  // the fold, where there are none.
  Sheets fold;
  fold.points = {{0, -9, 0}, {0, 9, 0}, {-9, 0, 0}, {-9, 0, 0.001}};
  fold.faces = {{0, 1, 2}, {1, 0, 3}};
  const std::array<Vec3d, 3> at{Vec3d{-1, -0.5, 0}, {2, 0, 0}, {-1, 0.5, 0}};
  const InputSheets::Gap gap = gapOf(fold, at, 1);
  EXPECT_EQ(gap.bound, kInfinity);
  EXPECT_FALSE(gap.isFar);
}

TEST(InputSheets, TheFlattestOfThreeTrianglesAtAnEdge) {
  meshes::Random random(1);
  Sheets plane = squares(6, 0, random);
  // Fins on the edges along y = 3.
  for (std::uint32_t i = 0; i < 6; ++i) {
    plane.points.push_back({i + 0.5, 3, 2});
    plane.faces.insert(plane.faces.begin() + 5 * i,
                       Face{7 * i + 3, 7 * i + 10, std::uint32_t(plane.points.size() - 1)});
  }
  EXPECT_NEAR(gapOf(plane, {Vec3d{1.2, 1.1, 0.1}, {4.8, 2.2, 0.1}, {2.9, 4.7, 0.1}}, 0.5).bound,
              0.1, 1e-12);
}

// Torn, doubled, turned, shaken and folded sheets: a bound is never below the distance.
TEST(InputSheets, BoundsOfBrokenSheets) {
  meshes::Random random(2);
  int bounded = 0, far = 0, unknown = 0;
  for (int round = 0; round < 60; ++round) {
    Sheets sheets = squares(7, random.between(0, 0.4), random);
    const std::size_t count = sheets.faces.size();
    for (std::size_t i = 0; i < random.below(9); ++i) {
      Face& face = sheets.faces[random.below(count)];
      switch (random.below(4)) {
      case 0:
        face[2] = face[1];
        break;
      case 1:
        std::swap(face[0], face[1]);
        break;
      case 2:
        sheets.faces.push_back(Face(face));
        break;
      default:
        for (std::size_t axis = 0; axis < 3; ++axis)
          sheets.points[face[0]][axis] += random.between(-1.5, 1.5);
      }
    }
    const TriangleTree tree(sheets.points, sheets.faces);
    const InputSheets all(tree, sheets.faces, sheets.points.size());
    for (int i = 0; i < 20; ++i) {
      std::array<Vec3d, 3> at;
      for (Vec3d& p : at)
        p = {random.between(0.2, 6.8), random.between(0.2, 6.8), random.between(-0.5, 0.5)};
      const Vec3d centre = times(plus(plus(at[0], at[1]), at[2]), 1.0 / 3);
      const double most = random.between(0.3, 1.5);
      const InputSheets::Gap gap = all.gap(at[0], at[1], at[2], nearestTo(tree, centre), most, 0);
      if (gap.bound <= most) {
        ++bounded;
        EXPECT_LE(largestDistance(sheets, at), gap.bound * (1 + 1e-9));
      } else {
        EXPECT_EQ(gap.bound, kInfinity);
        ++(gap.isFar ? far : unknown);
      }
    }
  }
  EXPECT_GT(bounded, 100);
  EXPECT_GT(far, 100);
  EXPECT_GT(unknown, 50);
}

} // namespace
} // namespace tetvdb
