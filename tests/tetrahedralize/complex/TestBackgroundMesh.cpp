// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/tetrahedralize/complex/BackgroundMesh.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <set>
#include <string>
#include <vector>

namespace tetvdb {
namespace {

__extension__ typedef __int128 Wide;

// Corners of the box around `inside`, grown by `grow`, then `inside` without repeats.
std::vector<Vec3d> boxed(const std::vector<Vec3d>& inside, double grow) {
  Box box;
  for (const Vec3d& p : inside)
    box.add(p);
  std::vector<Vec3d> points;
  std::set<Vec3d> seen;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3d p{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      p[axis] = ((corner >> axis) & 1) != 0 ? box.high[axis] + grow : box.low[axis] - grow;
    points.push_back(p);
    seen.insert(p);
  }
  for (const Vec3d& p : inside)
    if (seen.insert(p).second)
      points.push_back(p);
  return points;
}

// Six times the volume.
Wide volume(const std::vector<Vec3d>& points, const std::array<std::uint32_t, 4>& tet) {
  Wide m[3][3];
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t axis = 0; axis < 3; ++axis)
      m[row][axis] = static_cast<std::int64_t>(points[tet[row + 1]][axis]) -
                     static_cast<std::int64_t>(points[tet[0]][axis]);
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

std::array<std::uint32_t, 3> faceOf(const std::array<std::uint32_t, 4>& tet, std::size_t corner) {
  std::array<std::uint32_t, 3> face{};
  for (std::size_t i = 0; i < 3; ++i)
    face[i] = tet[(corner + i + 1) % 4];
  std::sort(face.begin(), face.end());
  return face;
}

bool onOneSide(const std::vector<Vec3d>& points, const std::array<std::uint32_t, 3>& face) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double x = points[face[0]][axis];
    if (x == points[face[1]][axis] && x == points[face[2]][axis] &&
        (x == points[0][axis] || x == points[7][axis]))
      return true;
  }
  return false;
}

// Positive tets that fill the box, over all points, neighbours across the faces they say.
void expectFillsBox(const std::vector<Vec3d>& points, const PlainTets& made) {
  ASSERT_EQ(made.tets.size(), made.neighbours.size());
  std::vector<char> used(points.size(), 0);
  Wide sum = 0, box = 6;
  std::size_t flat = 0, wrong = 0;
  for (std::size_t t = 0; t < made.tets.size(); ++t) {
    for (const std::uint32_t corner : made.tets[t])
      used.at(corner) = 1;
    const Wide v = volume(points, made.tets[t]);
    flat += v <= 0 ? 1 : 0;
    sum += v;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const auto face = faceOf(made.tets[t], corner);
      const std::uint32_t other = made.neighbours[t][corner];
      if (other == PlainTets::kNoTet) {
        wrong += onOneSide(points, face) ? 0 : 1;
        continue;
      }
      ASSERT_LT(other, made.tets.size());
      std::size_t back = 0;
      for (std::size_t i = 0; i < 4; ++i)
        back += made.neighbours[other][i] == t && faceOf(made.tets[other], i) == face ? 1 : 0;
      wrong += back == 1 ? 0 : 1;
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    box *= static_cast<std::int64_t>(points[7][axis] - points[0][axis]);
  EXPECT_EQ(flat, 0u);
  EXPECT_EQ(wrong, 0u);
  EXPECT_TRUE(sum == box);
  EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0);
}

// Points that lie within a tet's sphere by more than rounding, by the sphere's centre and radius.
std::size_t pointsInSpheres(const std::vector<Vec3d>& points, const PlainTets& made) {
  std::size_t found = 0;
  for (const auto& tet : made.tets) {
    using Real = long double;
    Real m[3][4];
    for (std::size_t row = 0; row < 3; ++row) {
      m[row][3] = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        m[row][axis] = 2 * (Real(points[tet[row + 1]][axis]) - points[tet[0]][axis]);
        m[row][3] += m[row][axis] * m[row][axis] / 4;
      }
    }
    for (std::size_t step = 0; step < 3; ++step) { // Gauss and Jordan, by the largest pivot
      std::size_t pivot = step;
      for (std::size_t row = step; row < 3; ++row)
        if (std::abs(m[row][step]) > std::abs(m[pivot][step]))
          pivot = row;
      std::swap(m[step], m[pivot]);
      for (std::size_t row = 0; row < 3; ++row) {
        const Real share = row == step ? 0 : m[row][step] / m[step][step];
        for (std::size_t column = 0; column < 4; ++column)
          m[row][column] -= share * m[step][column];
      }
    }
    Real centre[3], square = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Real offset = m[axis][3] / m[axis][axis];
      centre[axis] = points[tet[0]][axis] + offset;
      square += offset * offset;
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      Real away = 0;
      for (std::size_t axis = 0; axis < 3; ++axis)
        away += (points[i][axis] - centre[axis]) * (points[i][axis] - centre[axis]);
      found += away < square * (1 - Real(1e-9)) ? 1 : 0;
    }
  }
  return found;
}

std::vector<Vec3d> randomPoints(std::size_t count, double low, double high) {
  meshes::Random random(count);
  std::vector<Vec3d> points(count);
  for (Vec3d& p : points)
    for (double& x : p)
      x = std::floor(random.between(low, high));
  return points;
}

constexpr double kFar = 0x1p36;

TEST(DelaunayTets, BoxAlone) {
  Progress progress;
  for (const Vec3d& size : {Vec3d{1, 1, 1}, Vec3d{2, 3, 1e10}, Vec3d{1e11, 1, 1}}) {
    const std::vector<Vec3d> points = boxed({{0, 0, 0}, size}, 0);
    const PlainTets made = delaunayTets(points, 1, progress);
    EXPECT_EQ(made.tets.size(), 6u);
    expectFillsBox(points, made);
  }
}

TEST(DelaunayTets, SpheresOfRandomPointsAreEmpty) {
  Progress progress;
  for (const double extent : {20.0, 1000.0, kFar}) { // dense ones have many cospherical points
    const std::vector<Vec3d> points = boxed(randomPoints(600, -extent, extent), 10);
    const PlainTets made = delaunayTets(points, 1, progress);
    expectFillsBox(points, made);
    EXPECT_EQ(pointsInSpheres(points, made), 0u);
  }
}

TEST(DelaunayTets, ManyRandomPoints) {
  Progress progress;
  const std::vector<Vec3d> points = boxed(randomPoints(60000, -kFar, kFar), 0);
  expectFillsBox(points, delaunayTets(points, 1, progress));
}

TEST(DelaunayTets, RegularGrids) {
  Progress progress;
  for (const double step : {1.0, 3.0, 0x1p31 + 1}) {
    std::vector<Vec3d> grid;
    for (int x = 0; x < 20; ++x)
      for (int y = 0; y < 21; ++y)
        for (int z = 0; z < 22; ++z)
          grid.push_back({step * x, step * y, step * z});
    // Without a margin the grid lies on the box's sides, edges and corners too.
    for (const double grow : {0.0, 1.0, 5 * step}) {
      const std::vector<Vec3d> points = boxed(grid, grow);
      const PlainTets made = delaunayTets(points, 1, progress);
      expectFillsBox(points, made);
      if (grow == 0) { // five or six to a cube, and a few slivers
        EXPECT_NEAR(static_cast<double>(made.tets.size()), 5.5 * 19 * 20 * 21, 0.5 * 19 * 20 * 21);
      }
    }
  }
}

TEST(DelaunayTets, CoplanarPoints) {
  Progress progress;
  std::vector<Vec3d> level, skew, exactlySkew;
  meshes::Random random(5);
  for (int i = 0; i < 5000; ++i) {
    const double x = std::floor(random.between(0, 1e9)), y = std::floor(random.between(0, 1e9));
    level.push_back({x, y, 77});
    skew.push_back({x, y, std::floor(0.3 * x + 0.1 * y)});
    exactlySkew.push_back({x, y, x - 3 * y});
  }
  for (const auto* sheet : {&level, &skew, &exactlySkew})
    for (const double grow : {1.0, 1e8}) {
      const std::vector<Vec3d> points = boxed(*sheet, grow);
      expectFillsBox(points, delaunayTets(points, 1, progress));
    }
}

TEST(DelaunayTets, CollinearPoints) {
  Progress progress;
  std::vector<Vec3d> along, diagonal, two;
  for (int i = 0; i < 5000; ++i) {
    along.push_back({7.0 * i, 0, 0});
    diagonal.push_back({3.0 * i, 5.0 * i, -7.0 * i});
  }
  for (int i = 0; i < 600; ++i) // each interval of one line makes a tet with each of the other
    two.push_back(i % 2 == 0 ? Vec3d{1.0 * i, 300, 0} : Vec3d{300, 1.0 * i, 1000});
  for (const auto* line : {&along, &diagonal, &two})
    for (const double grow : {0.0, 1.0, 1e6}) {
      if (grow == 0 && line == &along)
        continue; // no box
      const std::vector<Vec3d> points = boxed(*line, grow);
      expectFillsBox(points, delaunayTets(points, 1, progress));
    }
}

TEST(DelaunayTets, CosphericalPoints) {
  // All whole solutions of x^2 + y^2 + z^2 = n, with and without the centre.
  Progress progress;
  constexpr int kSquare = 5 * 5 * 7 * 7 * 11 * 11;
  std::vector<Vec3d> sphere;
  for (int x = -385; x <= 385; ++x)
    for (int y = -385; y <= 385; ++y) {
      const int rest = kSquare - x * x - y * y;
      const int z = static_cast<int>(std::lround(std::sqrt(std::max(rest, 0))));
      if (z * z == rest) {
        sphere.push_back({1.0 * x, 1.0 * y, 1.0 * z});
        sphere.push_back({1.0 * x, 1.0 * y, -1.0 * z});
      }
    }
  ASSERT_GT(sphere.size(), 500u);
  const std::vector<Vec3d> hollow = boxed(sphere, 10);
  expectFillsBox(hollow, delaunayTets(hollow, 1, progress));
  sphere.push_back({0, 0, 0});
  const std::vector<Vec3d> centred = boxed(sphere, 0);
  expectFillsBox(centred, delaunayTets(centred, 1, progress));
}

TEST(DelaunayTets, ClustersOfUnitDistanceFarApart) {
  Progress progress;
  std::vector<Vec3d> clusters;
  for (const double cx : {-kFar, 0.0, kFar - 10})
    for (const double cy : {-kFar, kFar})
      for (const Vec3d& p : randomPoints(1000, 0, 9))
        clusters.push_back({cx + p[0], cy + p[1], p[2]});
  for (const double grow : {0.0, 1.0, kFar / 2}) {
    const std::vector<Vec3d> points = boxed(clusters, grow);
    expectFillsBox(points, delaunayTets(points, 1, progress));
  }
}

TEST(DelaunayTets, PointsOnTheBox) {
  Progress progress;
  std::vector<Vec3d> inside = randomPoints(4000, 0, 1000);
  meshes::Random random(9);
  for (Vec3d& p : inside)
    for (double& x : p)
      if (random.unit() < 0.5)
        x = random.unit() < 0.5 ? 0 : 1000;
  inside.push_back({0, 0, 0});
  inside.push_back({1000, 1000, 1000});
  const std::vector<Vec3d> points = boxed(inside, 0);
  const PlainTets made = delaunayTets(points, 1, progress);
  expectFillsBox(points, made);
}

TEST(DelaunayTets, TheSameEachTime) {
  Progress progress;
  const std::vector<Vec3d> points = boxed(randomPoints(5000, 0, 100), 1);
  const PlainTets first = delaunayTets(points, 1, progress),
                  second = delaunayTets(points, 1, progress);
  EXPECT_EQ(first.tets, second.tets);
  EXPECT_EQ(first.neighbours, second.neighbours);
}

TEST(DelaunayTets, ARepeatedPointIsAnError) {
  Progress progress;
  std::vector<Vec3d> points = boxed(randomPoints(100, 0, 1000), 1);
  points.push_back(points[50]);
  EXPECT_THROW(delaunayTets(points, 1, progress), Error);
}

TEST(DelaunayTets, CanBeCancelled) {
  Progress progress;
  progress.cancel();
  const std::vector<Vec3d> points = boxed(randomPoints(10000, 0, 1e6), 1);
  EXPECT_THROW(delaunayTets(points, 1, progress), Error);
}

// A sheet, a spike and a point-like triangle.
LatticeSoup someSoup(double scale) {
  LatticeSoup soup;
  const auto add = [&](double x, double y, double z) {
    soup.points.push_back({std::round(x * scale), std::round(y * scale), std::round(z * scale)});
  };
  add(0, 0, 0), add(10, 0, 0), add(0, 10, 3), add(5, 5, 20), add(5.1, 5, 20), add(2, 8, 15),
      add(2.01, 8, 15), add(2, 8.01, 15);
  soup.faces = {{0, 1, 2}, {0, 3, 4}, {5, 6, 7}};
  return soup;
}

double nearestFace(const LatticeSoup& soup, const Vec3d& p) {
  double minValue = Box::kInfinity;
  for (const auto& f : soup.faces)
    minValue = std::min(minValue,
                        nearestOnTriangle(minus(soup.points[f[0]], p), minus(soup.points[f[1]], p),
                                          minus(soup.points[f[2]], p))
                            .squared);
  return std::sqrt(minValue);
}

TEST(BackgroundPoints, FillTheBoxAwayFromTheSoup) {
  Progress progress;
  constexpr double kScale = 1e8, kMargin = 2e8, kSpacing = 1e8, kClearance = 5e7;
  const LatticeSoup soup = someSoup(kScale);
  const std::vector<Vec3d> points = backgroundPoints(soup, kMargin, kSpacing, kClearance, progress);
  EXPECT_EQ(points[0], (Vec3d{-kMargin, -kMargin, -kMargin}));
  EXPECT_EQ(points[1], (Vec3d{10 * kScale + kMargin, -kMargin, -kMargin}));
  EXPECT_EQ(points[7],
            (Vec3d{10 * kScale + kMargin, 10 * kScale + kMargin, 20 * kScale + kMargin}));
  for (std::size_t i = 0; i < soup.points.size(); ++i)
    EXPECT_EQ(points[8 + i], soup.points[i]);
  const Box box{points[0], points[7]};
  std::size_t onSides = 0;
  for (std::size_t i = 8 + soup.points.size(); i < points.size(); ++i) {
    EXPECT_TRUE(box.contains(points[i]));
    EXPECT_GE(nearestFace(soup, points[i]), kClearance);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(points[i][axis], std::round(points[i][axis]));
      onSides += points[i][axis] == box.low[axis] || points[i][axis] == box.high[axis] ? 1 : 0;
    }
  }
  EXPECT_GT(onSides, 400u); // the sides' area is 1,544 squares of spacing
  EXPECT_EQ(std::set<Vec3d>(points.begin(), points.end()).size(), points.size());

  // Nowhere is a ball without points but near the soup: the lattice's widest hole has 0.56 cells.
  meshes::Random random(3);
  for (int i = 0; i < 2000; ++i) {
    Vec3d p{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      p[axis] = random.between(box.low[axis], box.high[axis]);
    double minValue = nearestFace(soup, p);
    for (const Vec3d& q : points)
      minValue = std::min(minValue, length(minus(p, q)));
    EXPECT_LT(minValue, 1.0 * kSpacing);
  }
  expectFillsBox(points, delaunayTets(points, 1, progress));
}

TEST(BackgroundPoints, AnyShapeOfBox) {
  Progress progress;
  for (const Vec3d& size : {Vec3d{1, 0, 0}, Vec3d{5, 3, 2}, Vec3d{0, 1e10, 0}, Vec3d{1e11, 3e5, 2},
                            Vec3d{1e10, 1e10, 10}, Vec3d{40, 40, 40}})
    for (const double margin : {0.0, 1.5, 1e8})
      for (const double spacing : {1e9, 1e12}) {
        LatticeSoup soup;
        soup.points = {{0, 0, 0}, size};
        soup.faces = {{0, 1, 1}};
        const std::vector<Vec3d> points = backgroundPoints(soup, margin, spacing, 0, progress);
        EXPECT_LE(points.size(), 200010u);
        EXPECT_EQ(std::set<Vec3d>(points.begin(), points.end()).size(), points.size());
        if (points.size() < 20000)
          expectFillsBox(points, delaunayTets(points, 1, progress));
      }
}

TEST(BackgroundPoints, NoMoreThanEnoughOfThem) {
  Progress progress;
  const LatticeSoup soup = someSoup(1e8);
  for (const double spacing : {0.0, 1.0, 1e6}) {
    const std::size_t count = backgroundPoints(soup, 1e8, spacing, 1e7, progress).size();
    EXPECT_GT(count, 150000u);
    EXPECT_LE(count, 200000u + 8 + soup.points.size());
  }
}

TEST(BackgroundPoints, TheSameEachTime) {
  Progress progress;
  const LatticeSoup soup = someSoup(1e8);
  EXPECT_EQ(backgroundPoints(soup, 1e8, 1e8, 1e7, progress),
            backgroundPoints(soup, 1e8, 1e8, 1e7, progress));
}

} // namespace
} // namespace tetvdb
