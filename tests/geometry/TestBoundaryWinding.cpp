// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "SolidAngleOracle.h"
#include "tetvdb/geometry/BoundaryWinding.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

using Point = std::array<double, 3>; // whole numbers
struct Surface {
  std::vector<Point> points;
  std::vector<std::array<int, 3>> faces;
};

// The definition.
double windingBySolidAngles(const Surface& s, const Point& p) {
  long double total = 0;
  for (const auto& f : s.faces) {
    std::array<std::array<long double, 3>, 3> v;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        v[i][k] = static_cast<long double>(s.points[std::size_t(f[i])][k]) - p[k];
    total += test::solidAngle(v);
  }
  return static_cast<double>(total / test::kSphere);
}

// Signed faces that a ray down from p crosses. p is nowhere above or below an edge.
int crossingsBelow(const Surface& s, const Point& p) {
  int sum = 0;
  for (const auto& f : s.faces) {
    const Point &a = s.points[std::size_t(f[0])], &b = s.points[std::size_t(f[1])],
                &c = s.points[std::size_t(f[2])];
    const auto side = [&](const Point& u, const Point& v) {
      const long double d = (static_cast<long double>(v[0]) - u[0]) * (p[1] - u[1]) -
                            (static_cast<long double>(v[1]) - u[1]) * (p[0] - u[0]);
      EXPECT_NE(d, 0);
      return d > 0;
    };
    const bool ab = side(a, b), bc = side(b, c), ca = side(c, a);
    if (ab != bc || bc != ca)
      continue;
    long double n[3];
    for (int k = 0; k < 3; ++k) {
      const auto i = std::size_t((k + 1) % 3), j = std::size_t((k + 2) % 3);
      n[k] = (static_cast<long double>(b[i]) - a[i]) * (static_cast<long double>(c[j]) - a[j]) -
             (static_cast<long double>(b[j]) - a[j]) * (static_cast<long double>(c[i]) - a[i]);
    }
    // Height of the plane at p's column, against p.
    const long double z = a[2] - (n[0] * (p[0] - a[0]) + n[1] * (p[1] - a[1])) / n[2];
    if (z < p[2])
      sum += n[2] < 0 ? 1 : -1; // a face that looks down is entered by a ray up
  }
  return sum;
}

std::vector<BoundaryEdge> boundaryEdgesOf(const Surface& s) {
  std::map<std::pair<int, int>, int> sums;
  for (const auto& f : s.faces)
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = f[i], b = f[(i + 1) % 3];
      sums[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  std::vector<BoundaryEdge> boundary;
  const auto point = [&](int i) {
    const Point& p = s.points[std::size_t(i)];
    return LatticePoint{p[0], p[1], p[2]};
  };
  for (const auto& [edge, sum] : sums)
    if (sum > 0)
      boundary.push_back({point(edge.first), point(edge.second), sum});
    else if (sum < 0)
      boundary.push_back({point(edge.second), point(edge.first), -sum});
  return boundary;
}

// A wavy sheet over a disc, n rings; `keep` decides which faces are there.
template <typename Keep>
Surface wavySheet(int n, double size, Keep keep) {
  Surface s;
  s.points.push_back({0, 0, 0});
  const int around = 3 * n;
  for (int r = 1; r <= n; ++r)
    for (int k = 0; k < around; ++k) {
      const double t = 6.283185307179586 * k / around, d = size * r / n;
      s.points.push_back({std::round(d * std::cos(t)), std::round(d * std::sin(t)),
                          std::round(0.4 * size * std::sin(3 * t) * r / n + d * d / size)});
    }
  const auto at = [&](int r, int k) { return r == 0 ? 0 : 1 + (r - 1) * around + k % around; };
  for (int r = 0; r < n; ++r)
    for (int k = 0; k < around; ++k) {
      if (keep())
        s.faces.push_back({at(r, k), at(r + 1, k), at(r + 1, k + 1)});
      if (r > 0 && keep())
        s.faces.push_back({at(r, k), at(r + 1, k + 1), at(r, k + 1)});
    }
  return s;
}

// Points of odd coordinates, while the surface's are even: nothing is above or below an edge.
Point anyPoint(meshes::Random& random, double size) {
  Point p{};
  for (double& c : p)
    c = 2 * std::round(random.between(-size, size) / 2) + 1;
  return p;
}

// Moves every point to even numbers near it.
void bringToGeneralPosition(Surface& s, meshes::Random& random) {
  for (Point& p : s.points)
    for (double& c : p)
      c = 2 * std::round(c / 2) + 2 * std::round(random.between(-9, 9));
}

void compareWithDefinition(Surface s, double size, double tolerance, std::uint64_t seed) {
  meshes::Random random(seed);
  bringToGeneralPosition(s, random);
  const BoundaryWinding boundary(boundaryEdgesOf(s));
  for (int i = 0; i < 500; ++i) {
    const Point p = anyPoint(random, 2 * size);
    EXPECT_NEAR(crossingsBelow(s, p) + boundary.at({p[0], p[1], p[2]}), windingBySolidAngles(s, p),
                tolerance);
  }
}

constexpr double kSize = 3e7;

TEST(BoundaryWinding, ClosedSurfaceHasNone) {
  EXPECT_TRUE(BoundaryWinding({}).empty());
  EXPECT_EQ(BoundaryWinding({}).at({1, 2, 3}), 0);
}

TEST(BoundaryWinding, OneTriangle) {
  Surface s{{{0, 0, 0}, {kSize, 0, 1e6}, {0, kSize, -1e6}}, {{0, 1, 2}}};
  compareWithDefinition(s, kSize, 1e-12, 1);
}

TEST(BoundaryWinding, SheetWithItsBoundaryEdges) {
  compareWithDefinition(wavySheet(20, kSize, [] { return true; }), kSize, kBoundaryWindingError, 2);
}

TEST(BoundaryWinding, SheetFullOfHoles) {
  meshes::Random random(3);
  compareWithDefinition(wavySheet(30, kSize, [&] { return random.unit() < 0.7; }), kSize,
                        kBoundaryWindingError, 4);
}

// A tangle: triangles anywhere, none of which meet.
TEST(BoundaryWinding, ManyEdgesAreLookedAtRoughly) {
  meshes::Random random(21);
  Surface s;
  for (int i = 0; i < 2000; ++i) {
    const Point c = anyPoint(random, kSize);
    for (int k = 0; k < 3; ++k) {
      Point p = anyPoint(random, 0.2 * kSize);
      for (std::size_t a = 0; a < 3; ++a)
        p[a] = 2 * std::round((p[a] + c[a]) / 2);
      s.points.push_back(p);
    }
    s.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const BoundaryWinding boundary(boundaryEdgesOf(s));
  ASSERT_TRUE(boundary.rough());
  for (int i = 0; i < 200; ++i) {
    const Point p = anyPoint(random, 1.5 * kSize);
    EXPECT_NEAR(crossingsBelow(s, p) + boundary.at({p[0], p[1], p[2]}), windingBySolidAngles(s, p),
                kRoughWindingError);
  }
}

// A closed surface whose faces look any way is nothing but boundary: one net of edges, of which
// every cluster has many loose ends.
TEST(BoundaryWinding, FacesThatLookAnyWay) {
  meshes::Random random(22);
  Surface s = wavySheet(50, kSize, [] { return true; });
  bringToGeneralPosition(s, random);
  for (auto& face : s.faces)
    if (random.unit() < 0.3)
      std::swap(face[0], face[1]);
  const BoundaryWinding boundary(boundaryEdgesOf(s));
  ASSERT_TRUE(boundary.rough());
  double sum = 0;
  int looked = 0;
  const auto compare = [&](const Point& p, double s_) {
    const double error = std::abs(crossingsBelow(s, p) + s_ - windingBySolidAngles(s, p));
    EXPECT_LE(error, 2 * kRoughWindingError);
    sum += error;
    ++looked;
  };
  for (int i = 0; i < 60; ++i) {
    // Half of them at the surface, where most is near.
    Point p = anyPoint(random, 1.5 * kSize);
    if (i % 2 == 0)
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = s.points[std::size_t(i) * 97 % s.points.size()][k] +
               2 * std::round(random.between(-0.02, 0.02) * kSize / 2) + 1;
    compare(p, boundary.at({p[0], p[1], p[2]}));
    BoundaryPoints points;
    const double step = 2 * std::round(0.002 * kSize);
    for (int k = 0; k < 27; ++k) {
      points.x.push_back(p[0] + step * (k / 9 - 1));
      points.y.push_back(p[1] + step * (k / 3 % 3 - 1));
      points.z.push_back(p[2] + step * (k % 3 - 1));
    }
    boundary.at({p[0], p[1], p[2]}, 2 * step, points);
    for (std::size_t k = 0; k < points.size(); k += 13)
      compare({points.x[k], points.y[k], points.z[k]}, points.sum[k]);
  }
  EXPECT_LT(sum / looked, kRoughWindingError / 16);
}

TEST(BoundaryWinding, FarFromTheOrigin) {
  Surface s = wavySheet(10, kSize, [] { return true; });
  meshes::Random random(5);
  const BoundaryWinding near(boundaryEdgesOf(s));
  const double far = 0x1p50;
  for (Point& p : s.points)
    for (double& c : p)
      c += far;
  const BoundaryWinding moved(boundaryEdgesOf(s));
  for (int i = 0; i < 100; ++i) {
    const Point p = anyPoint(random, 2 * kSize);
    EXPECT_EQ(near.at({p[0], p[1], p[2]}), moved.at({p[0] + far, p[1] + far, p[2] + far}));
  }
}

TEST(BoundaryWinding, ManyPointsAtOnce) {
  meshes::Random random(15);
  const Surface s = wavySheet(25, kSize, [&] { return random.unit() < 0.8; });
  const BoundaryWinding boundary(boundaryEdgesOf(s));
  for (int i = 0; i < 50; ++i) {
    const Point c = anyPoint(random, 1.5 * kSize);
    const double reach = 1e6;
    BoundaryPoints points;
    for (int k = 0; k < 37; ++k) {
      points.x.push_back(c[0] + std::round(random.between(-0.57, 0.57) * reach));
      points.y.push_back(c[1] + std::round(random.between(-0.57, 0.57) * reach));
      points.z.push_back(c[2] + std::round(random.between(-0.57, 0.57) * reach));
    }
    boundary.at({c[0], c[1], c[2]}, reach, points);
    for (std::size_t k = 0; k < points.size(); ++k)
      EXPECT_NEAR(points.sum[k], boundary.at({points.x[k], points.y[k], points.z[k]}),
                  2 * kBoundaryWindingError);
  }
}

TEST(BoundaryWinding, OrderOfEdgesHasNoPart) {
  meshes::Random random(6);
  const Surface s = wavySheet(20, kSize, [&] { return random.unit() < 0.8; });
  std::vector<BoundaryEdge> edges = boundaryEdgesOf(s);
  const BoundaryWinding one(edges);
  std::reverse(edges.begin(), edges.end());
  std::rotate(edges.begin(), edges.begin() + 17, edges.end());
  const BoundaryWinding other(edges);
  for (int i = 0; i < 200; ++i) {
    const Point p = anyPoint(random, 2 * kSize);
    EXPECT_EQ(one.at({p[0], p[1], p[2]}), other.at({p[0], p[1], p[2]}));
  }
}

// On the curtain itself the point moved by (e, e^2, e^3) decides.
TEST(BoundaryWinding, TiesFallToTheSideOfThePerturbedPoint) {
  const std::vector<BoundaryEdge> square = {{{0, 0, 0}, {100, 0, 0}, 1},
                                            {{100, 0, 0}, {100, 100, 0}, 1},
                                            {{100, 100, 0}, {0, 100, 0}, 1},
                                            {{0, 100, 0}, {0, 0, 0}, 1}};
  const BoundaryWinding boundary(square);
  for (const double x : {0.0, 40.0, 100.0})
    for (const double y : {0.0, 60.0, 100.0}) {
      // The same a thousandth aside, on the side of the perturbation.
      std::vector<BoundaryEdge> scaled = square;
      for (BoundaryEdge& e : scaled)
        for (LatticePoint* p : {&e.a, &e.b})
          *p = {p->x * 1e6, p->y * 1e6, p->z * 1e6};
      const BoundaryWinding fine(scaled);
      for (const double z : {-50.0, 50.0})
        EXPECT_NEAR(boundary.at({x, y, z}), fine.at({x * 1e6 + 1000, y * 1e6 + 1, z * 1e6}), 1e-3)
            << x << ' ' << y << ' ' << z;
    }
}

TEST(BoundaryWinding, SlopePredictsWithinItsBounds) {
  meshes::Random random(7);
  const Surface s = wavySheet(12, kSize, [&] { return random.unit() < 0.9; });
  const BoundaryWinding boundary(boundaryEdgesOf(s));
  int useful = 0;
  double largest = 0;
  for (int i = 0; i < 600; ++i) {
    const Point c = anyPoint(random, 2 * kSize);
    const double reach = (i % 2 == 0 ? 0.05 : 0.3) * kSize;
    const BoundaryWinding::Slope slope = boundary.slope({c[0], c[1], c[2]}, reach);
    if (!std::isfinite(slope.bend))
      continue;
    ++useful;
    const double here = boundary.at({c[0], c[1], c[2]});
    for (int k = 0; k < 10; ++k) {
      Point d{};
      for (std::size_t a = 0; a < 3; ++a)
        d[a] = std::round(random.between(-1, 1) * reach / 1.8);
      const double there = boundary.at({c[0] + d[0], c[1] + d[1], c[2] + d[2]});
      const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      double change = there - here;
      change -= slope.gradient[0] * d[0] + slope.gradient[1] * d[1] + slope.gradient[2] * d[2];
      change -= std::round(change); // the curtain changes it by whole numbers
      const double bound =
          slope.bend * square / 2 + slope.error * std::sqrt(square) + 2 * kBoundaryWindingError;
      EXPECT_LE(std::abs(change), bound);
      if (bound < 0.3)
        largest = std::max(largest, std::abs(change) / bound);
    }
  }
  EXPECT_GT(useful, 200);
  EXPECT_GT(largest, 0.02) << "the bounds are far from sharp";
}

TEST(BoundaryWinding, OnABoundaryEdgeThePerturbedPointDecides) {
  // Points of the boundary of a square, and the same a little aside.
  const auto scaled = [](double f) {
    return std::vector<BoundaryEdge>{{{0, 0, 0}, {100 * f, 0, 20 * f}, 1},
                                     {{100 * f, 0, 20 * f}, {100 * f, 100 * f, 0}, 1},
                                     {{100 * f, 100 * f, 0}, {0, 100 * f, 0}, 1},
                                     {{0, 100 * f, 0}, {0, 0, 0}, 1}};
  };
  const BoundaryWinding boundary(scaled(1)), fine(scaled(1e9));
  for (const Point& p : {Point{50, 0, 10}, Point{100, 50, 10}, Point{40, 100, 0}, Point{0, 70, 0},
                         Point{0, 0, 0}, Point{100, 0, 20}, Point{100, 100, 0}, Point{0, 100, 0}})
    EXPECT_NEAR(boundary.at({p[0], p[1], p[2]}),
                fine.at({p[0] * 1e9 + 1e6, p[1] * 1e9 + 1e3, p[2] * 1e9 + 1}), 2e-3)
        << p[0] << ' ' << p[1] << ' ' << p[2];
}

} // namespace
} // namespace tetvdb
