// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/geometry/FillHoles.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

using Place = std::tuple<double, double, double>;
using EdgeSums = std::map<std::pair<Place, Place>, long>;

Place placeOf(const LatticePoint& p) {
  return {p.x, p.y, p.z};
}

void addEdge(EdgeSums& sums, const LatticePoint& a, const LatticePoint& b, long weight) {
  const Place p = placeOf(a), q = placeOf(b);
  if (p < q)
    sums[{p, q}] += weight;
  else if (q < p)
    sums[{q, p}] -= weight;
}

EdgeSums withoutZeros(EdgeSums sums) {
  for (auto i = sums.begin(); i != sums.end();)
    i = i->second == 0 ? sums.erase(i) : std::next(i);
  return sums;
}

EdgeSums sumsOf(const std::vector<BoundaryEdge>& edges) {
  EdgeSums sums;
  for (const BoundaryEdge& e : edges)
    addEdge(sums, e.a, e.b, e.weight);
  return withoutZeros(std::move(sums));
}

EdgeSums sumsOf(const std::vector<FillTriangle>& triangles) {
  EdgeSums sums;
  for (const FillTriangle& t : triangles) {
    EXPECT_GT(t.weight, 0);
    addEdge(sums, t.a, t.b, t.weight);
    addEdge(sums, t.b, t.c, t.weight);
    addEdge(sums, t.c, t.a, t.weight);
  }
  return withoutZeros(std::move(sums));
}

std::vector<BoundaryEdge> loop(int n, double size, double shift, std::int32_t weight) {
  std::vector<BoundaryEdge> edges;
  const auto at = [&](int i) {
    const double t = 6.283185307179586 * (i % n) / n;
    return LatticePoint{std::round(size * std::cos(t)) + shift, std::round(size * std::sin(t)),
                        std::round(0.1 * size * std::sin(5 * t))};
  };
  for (int i = 0; i < n; ++i)
    edges.push_back({at(i), at(i + 1), weight});
  return edges;
}

// Boundary edges of triangles between random points of a small lattice: a net.
std::vector<BoundaryEdge> net(std::uint64_t seed, int faces) {
  meshes::Random random(seed);
  std::vector<BoundaryEdge> edges;
  for (int i = 0; i < faces; ++i) {
    LatticePoint p[3];
    for (LatticePoint& q : p)
      q = {std::round(random.between(0, 4)), std::round(random.between(0, 4)),
           std::round(random.between(0, 4))};
    const auto weight = static_cast<std::int32_t>(std::round(random.between(1, 3)));
    for (std::size_t k = 0; k < 3; ++k)
      edges.push_back({p[k], p[(k + 1) % 3], weight});
  }
  return edges;
}

TEST(FillHoles, NothingToFill) {
  EXPECT_TRUE(fillHoles({}).empty());
  // Two faces, back to back, that share no point by name.
  std::vector<BoundaryEdge> edges = loop(7, 1000, 0, 1);
  for (BoundaryEdge e : loop(7, 1000, 0, 1))
    edges.push_back({e.b, e.a, 1});
  EXPECT_TRUE(fillHoles(edges).empty());
}

TEST(FillHoles, LoopsOfAnyLength) {
  for (const int n : {3, 4, 5, 8, 100, 2047, 2048, 5000}) {
    const std::vector<BoundaryEdge> edges = loop(n, 1e7, 0, 2);
    const auto triangles = fillHoles(edges);
    EXPECT_EQ(triangles.size(), std::size_t(n) - 2);
    EXPECT_EQ(sumsOf(triangles), sumsOf(edges));
    for (const FillTriangle& t : triangles)
      EXPECT_EQ(t.weight, 2);
  }
}

// The holes of two loops with a point in common are filled one by one.
TEST(FillHoles, LoopsThatTouch) {
  std::vector<BoundaryEdge> edges = loop(40, 1000, 0, 1);
  for (const BoundaryEdge& e : loop(60, 1000, 2000, 1))
    edges.push_back(e);
  const auto triangles = fillHoles(edges);
  EXPECT_EQ(triangles.size(), 38u + 58u);
  EXPECT_EQ(sumsOf(triangles), sumsOf(edges));
  for (const FillTriangle& t : triangles)
    EXPECT_TRUE(std::max({t.a.x, t.b.x, t.c.x}) <= 1000 || std::min({t.a.x, t.b.x, t.c.x}) >= 1000);
}

TEST(FillHoles, NetsSumUp) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const std::vector<BoundaryEdge> edges = net(seed, 3 + static_cast<int>(seed) * 12);
    EXPECT_EQ(sumsOf(fillHoles(edges)), sumsOf(edges));
  }
}

TEST(FillHoles, OrderOfEdgesHasNoPart) {
  std::vector<BoundaryEdge> edges = net(99, 300);
  const auto list = [&] {
    std::vector<std::tuple<Place, Place, Place, int>> all;
    for (const FillTriangle& t : fillHoles(edges))
      all.emplace_back(placeOf(t.a), placeOf(t.b), placeOf(t.c), t.weight);
    return all;
  };
  const auto expected = list();
  std::reverse(edges.begin(), edges.end());
  EXPECT_EQ(list(), expected);
  std::rotate(edges.begin(), edges.begin() + 71, edges.end());
  EXPECT_EQ(list(), expected);
}

TEST(FillHoles, NoTriangleIsLongerThanARasterTakes) {
  const std::vector<BoundaryEdge> edges = loop(64, 0x1p43, 0, 1);
  const auto triangles = fillHoles(edges);
  EXPECT_GT(triangles.size(), 62u);
  EXPECT_EQ(sumsOf(triangles), sumsOf(edges));
  for (const FillTriangle& t : triangles) {
    EXPECT_LE(std::max({t.a.x, t.b.x, t.c.x}) - std::min({t.a.x, t.b.x, t.c.x}), kMaxTetExtent);
    EXPECT_LE(std::max({t.a.y, t.b.y, t.c.y}) - std::min({t.a.y, t.b.y, t.c.y}), kMaxTetExtent);
  }
}

} // namespace
} // namespace tetvdb
