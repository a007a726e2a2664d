// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/TriangulatePolygon.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;
using Loop = std::vector<std::uint32_t>;

const EdgeTaken kAllFree = [](std::uint32_t, std::uint32_t) { return false; };

// Twice the area of each triangle seen along z, none of which may be 0 or less; their sum.
double planarArea(const std::vector<Vec3d>& points, const Loop& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const Vec3d &a = points[corners[i]], &b = points[corners[i + 1]], &c = points[corners[i + 2]];
    const double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    EXPECT_GT(area, 0);
    sum += area / 2;
  }
  return sum;
}

double shoelace(const std::vector<Vec3d>& points, const std::vector<Loop>& loops) {
  double sum = 0;
  for (const Loop& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec3d &a = points[loop[i]], &b = points[loop[(i + 1) % loop.size()]];
      sum += (a[0] * b[1] - a[1] * b[0]) / 2;
    }
  return sum;
}

// Edges that are run along in one direction alone are those of the loops.
void expectBoundary(const Loop& corners, const std::vector<Loop>& loops) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses, excess;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::uint32_t a = corners[i], b = corners[i % 3 == 2 ? i - 2 : i + 1];
    EXPECT_EQ((++uses[{a, b}]), 1);
    ++excess[{a, b}];
    --excess[{b, a}];
  }
  std::size_t edges = 0;
  for (const Loop& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i, ++edges)
      EXPECT_EQ((excess[{loop[i], loop[(i + 1) % loop.size()]}]), 1);
  std::size_t found = 0;
  for (const auto& [edge, count] : excess)
    found += count > 0;
  EXPECT_EQ(found, edges);
}

void expectFilled(const std::vector<Vec3d>& points, const std::vector<Loop>& loops) {
  Loop corners;
  ASSERT_TRUE(triangulatePolygon(points, loops, {0, 0, 1}, kAllFree, corners));
  EXPECT_NEAR(planarArea(points, corners), shoelace(points, loops), 1e-12);
  expectBoundary(corners, loops);
}

Loop all(const std::vector<Vec3d>& points) {
  Loop loop(points.size());
  std::iota(loop.begin(), loop.end(), 0u);
  return loop;
}

TEST(TriangulatePolygon, StarsAndCombs) {
  Random random(5);
  for (int n : {3, 4, 7, 30, 150}) {
    std::vector<Vec3d> points;
    for (int i = 0; i < n; ++i) {
      const double r = 0.2 + random.unit(), angle = 2 * kPi * i / n;
      points.push_back({r * std::cos(angle), r * std::sin(angle), 0.3});
    }
    expectFilled(points, {all(points)});
  }
  std::vector<Vec3d> comb;
  for (int i = 0; i < 20; ++i)
    comb.push_back({double(i), i % 2 == 0 ? 0.0 : 5.0, 0});
  comb.push_back({19, 6, 0});
  comb.push_back({-1, 6, 0});
  expectFilled(comb, {all(comb)});
}

TEST(TriangulatePolygon, PointsOnALineKeepTheirArea) {
  std::vector<Vec3d> points;
  for (int side = 0; side < 4; ++side)
    for (int i = 0; i < 6; ++i) {
      const double t = i / 6.0;
      const Vec3d at[4] = {{t, 0, 0}, {1, t, 0}, {1 - t, 1, 0}, {0, 1 - t, 0}};
      points.push_back(at[side]);
    }
  expectFilled(points, {all(points)});
}

TEST(TriangulatePolygon, HolesStayOpen) {
  std::vector<Vec3d> points;
  std::vector<Loop> loops(1);
  const auto add = [&](double x, double y, double r, int n, bool clockwise) {
    Loop loop;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * kPi * i / n * (clockwise ? -1 : 1);
      loop.push_back(static_cast<std::uint32_t>(points.size()));
      points.push_back({x + r * std::cos(angle), y + r * std::sin(angle), 0});
    }
    return loop;
  };
  loops[0] = add(0, 0, 3, 40, false);
  for (int i = 0; i < 5; ++i)
    loops.push_back(add(2 * std::cos(i), 2 * std::sin(i), 0.4, 9 + i, true));
  loops.push_back(add(0, 0, 0.5, 3, true));
  expectFilled(points, loops);
}

TEST(TriangulatePolygon, SeenFromBelow) {
  const std::vector<Vec3d> points{{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}};
  Loop corners;
  ASSERT_TRUE(triangulatePolygon(points, {{0, 1, 2, 3}}, {0, 0, -1}, kAllFree, corners));
  EXPECT_EQ(corners.size(), 6u);
  expectBoundary(corners, {{0, 1, 2, 3}});
}

TEST(TriangulatePolygon, AvoidsEdgesThatExist) {
  const std::vector<Vec3d> points{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};
  for (const bool first : {true, false}) {
    Loop corners;
    ASSERT_TRUE(triangulatePolygon(
        points, {{0, 1, 2, 3}}, {0, 0, 1},
        [&](std::uint32_t a, std::uint32_t b) { return (a + b == 2) == first && (a + b) % 2 == 0; },
        corners));
    std::map<std::uint32_t, int> uses;
    for (const std::uint32_t c : corners)
      ++uses[c];
    EXPECT_EQ(uses[0], first ? 1 : 2);
  }
}

TEST(TriangulatePolygon, HolesThatTouchTheOutlineOrOneAnother) {
  // At a point of the outline, and two holes at a point of each other.
  const std::vector<Vec3d> points{{0, 0, 0}, {6, 0, 0}, {6, 6, 0}, {0, 6, 0}, {2, 1, 0},
                                  {1, 2, 0}, {3, 3, 0}, {2, 4, 0}, {4, 4, 0}, {5, 3, 0}};
  expectFilled(points, {{0, 1, 2, 3}, {0, 5, 4}});
  expectFilled(points, {{0, 1, 2, 3}, {4, 5, 6}, {6, 7, 8}});
  expectFilled(points, {{0, 1, 2, 3}, {0, 5, 4}, {6, 7, 8, 9}});
}

// Corners of size^2 cells, sheared so that not all lines are along the axes.
std::vector<Vec3d> shearedGrid(std::uint32_t size) {
  std::vector<Vec3d> points;
  for (std::uint32_t i = 0; i <= size; ++i)
    for (std::uint32_t k = 0; k <= size; ++k)
      points.push_back({i + 0.125 * k, k - 0.25 * i, 0.5});
  return points;
}

TEST(TriangulatePolygon, RegionsOfCellsThatTouchAtCorners) {
  // Any set of the cells of a grid: its boundary runs through corners twice where cells touch
  // there.
  Random random(17);
  constexpr std::uint32_t kSize = 7;
  for (int round = 0; round < 200; ++round) {
    const std::vector<Vec3d> points = shearedGrid(kSize);
    const double share = random.unit();
    std::vector<char> isFull(kSize * kSize);
    for (char& full : isFull)
      full = random.unit() < share;
    std::vector<PolygonEdge> edges;
    double area = 0;
    const auto full = [&](std::uint32_t i, std::uint32_t k) {
      return i < kSize && k < kSize && isFull[i * kSize + k] != 0;
    };
    const auto at = [&](std::uint32_t i, std::uint32_t k) { return i * (kSize + 1) + k; };
    for (std::uint32_t i = 0; i < kSize; ++i)
      for (std::uint32_t k = 0; k < kSize; ++k) {
        if (!full(i, k))
          continue;
        area += 1 + 0.125 * 0.25;
        if (!full(i, k - 1))
          edges.emplace_back(at(i, k), at(i + 1, k));
        if (!full(i + 1, k))
          edges.emplace_back(at(i + 1, k), at(i + 1, k + 1));
        if (!full(i, k + 1))
          edges.emplace_back(at(i + 1, k + 1), at(i, k + 1));
        if (!full(i - 1, k))
          edges.emplace_back(at(i, k + 1), at(i, k));
      }
    if (edges.empty())
      continue;
    Loop corners;
    ASSERT_TRUE(
        triangulateEdges(points, edges, {}, {0, 0, 1}, kAllFree, Overlaps::Refused, corners));
    EXPECT_NEAR(planarArea(points, corners), area, 1e-12);
    std::map<PolygonEdge, int> excess;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const std::uint32_t a = corners[i], b = corners[i % 3 == 2 ? i - 2 : i + 1];
      ++excess[{a, b}];
      --excess[{b, a}];
    }
    for (const PolygonEdge& edge : edges) {
      EXPECT_EQ(excess[edge], 1);
      excess[edge] = excess[{edge.second, edge.first}] = 0;
    }
    for (const auto& [edge, sum] : excess)
      EXPECT_EQ(sum, 0);
  }
}

TEST(TriangulatePolygon, InnerPointsAreCorners) {
  const std::vector<Vec3d> points{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {2, 1, 0}, {1, 2, 0}};
  Loop corners;
  ASSERT_TRUE(triangulateEdges(points, {{0, 1}, {1, 2}, {2, 0}}, {3, 4, 5}, {0, 0, 1}, kAllFree,
                               Overlaps::Refused, corners));
  EXPECT_NEAR(planarArea(points, corners), 8, 1e-14);
  expectBoundary(corners, {{0, 1, 2}});
  EXPECT_EQ(corners.size(), 3u * 7u);
  EXPECT_EQ(std::set<std::uint32_t>(corners.begin(), corners.end()).size(), 6u);
}

TEST(TriangulatePolygon, RefusesWhatHasNoInside) {
  const std::vector<Vec3d> points{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 0, 0}};
  for (const std::vector<PolygonEdge>& edges : std::vector<std::vector<PolygonEdge>>{
           {},
           {{0, 1}, {1, 2}},                         // open
           {{0, 3}, {3, 2}, {2, 1}, {1, 0}},         // clockwise
           {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 1}}, // an edge twice
           {{0, 1}, {1, 2}, {2, 4}, {4, 3}, {3, 0}}, // through a point of its own
           {{0, 4}, {4, 1}, {1, 0}}}) {              // without area
    Loop corners;
    EXPECT_FALSE(
        triangulateEdges(points, edges, {}, {0, 0, 1}, kAllFree, Overlaps::Refused, corners));
    EXPECT_TRUE(corners.empty());
  }
}

TEST(TriangulatePolygon, MergesRegionsThatOverlap) {
  // Cells of a sheared grid with winding numbers from -1 to 2: the edges between two cells are as
  // many as their winding numbers differ by.
  Random random(23);
  constexpr std::uint32_t kSize = 6;
  for (int round = 0; round < 200; ++round) {
    const std::vector<Vec3d> points = shearedGrid(kSize);
    std::array<std::array<int, kSize + 2>, kSize + 2> winding{};
    double area = 0;
    bool simple = true;
    const double share = random.unit();
    for (std::uint32_t i = 1; i <= kSize; ++i)
      for (std::uint32_t k = 1; k <= kSize; ++k) {
        winding[i][k] = random.unit() < share ? static_cast<int>(random.below(4)) - 1 : 1;
        area += winding[i][k] > 0 ? 1 + 0.125 * 0.25 : 0;
        simple = simple && winding[i][k] >= 0 && winding[i][k] <= 1;
      }
    std::vector<PolygonEdge> edges;
    const auto add = [&](std::uint32_t from, std::uint32_t to, int count) {
      const PolygonEdge edge = count > 0 ? PolygonEdge{from, to} : PolygonEdge{to, from};
      edges.insert(edges.end(), static_cast<std::size_t>(std::abs(count)), edge);
    };
    const auto at = [&](std::uint32_t i, std::uint32_t k) { return i * (kSize + 1) + k; };
    for (std::uint32_t i = 0; i <= kSize; ++i)
      for (std::uint32_t k = 0; k <= kSize; ++k) {
        if (i < kSize)
          add(at(i, k), at(i + 1, k), winding[i + 1][k + 1] - winding[i + 1][k]);
        if (k < kSize)
          add(at(i, k), at(i, k + 1), winding[i][k + 1] - winding[i + 1][k + 1]);
      }
    Loop corners;
    EXPECT_EQ(triangulateEdges(points, edges, {}, {0, 0, 1}, kAllFree, Overlaps::Refused, corners),
              simple && area > 0);
    corners.clear();
    ASSERT_EQ(triangulateEdges(points, edges, {}, {0, 0, 1}, kAllFree, Overlaps::Merged, corners),
              area > 0);
    EXPECT_NEAR(planarArea(points, corners), area, 1e-12);
  }
}

TEST(TriangulatePolygon, RefusesWhatCrossesItself) {
  const std::vector<Vec3d> points{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
  Loop corners;
  EXPECT_FALSE(triangulatePolygon(points, {{0, 1, 2, 3}}, {0, 0, 1}, kAllFree, corners));
  EXPECT_TRUE(corners.empty());
}

} // namespace
} // namespace tetvdb
