// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/geometry/FaceContact.h"
#include "tetvdb/geometry/Orientation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <vector>

namespace tetvdb {
namespace {

using meshes::Random;
using Int = std::int64_t;
using Whole = std::array<Int, 3>;

Whole less(const Whole& a, const Whole& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Whole times(const Whole& a, Int s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}
Int dot(const Whole& a, const Whole& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Whole cross(const Whole& a, const Whole& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// A point with a common denominator, above 0.
struct Fraction {
  Whole top;
  Int bottom;
};

bool inTriangle(const std::array<Whole, 3>& t, const Fraction& x) {
  const Whole n = cross(less(t[1], t[0]), less(t[2], t[0]));
  if (dot(n, less(x.top, times(t[0], x.bottom))) != 0)
    return false;
  for (std::size_t k = 0; k < 3; ++k)
    if (dot(n, cross(less(t[(k + 1) % 3], t[k]), less(x.top, times(t[k], x.bottom)))) < 0)
      return false;
  return true;
}

// What two triangles have in common is convex; its corners are corners of one in the other, and
// points where an edge of one crosses the other's plane or an edge of it.
std::vector<Fraction> cornersInCommon(const std::array<Whole, 3>& a,
                                      const std::array<Whole, 3>& b) {
  std::vector<Fraction> all;
  const auto offer = [&](const Fraction& x) {
    if (inTriangle(a, x) && inTriangle(b, x))
      all.push_back(x);
  };
  const auto pointAt = [](const Whole& p, const Whole& way, Int top, Int bottom) {
    if (bottom < 0) {
      top = -top;
      bottom = -bottom;
    }
    Fraction x{times(p, bottom), bottom};
    for (std::size_t axis = 0; axis < 3; ++axis)
      x.top[axis] += top * way[axis];
    return x;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    offer({a[i], 1});
    offer({b[i], 1});
    for (const auto& [edges, plane] : {std::pair(a, b), std::pair(b, a)}) {
      const Whole p = edges[i], way = less(edges[(i + 1) % 3], p);
      const Whole n = cross(less(plane[1], plane[0]), less(plane[2], plane[0]));
      if (dot(n, way) != 0)
        offer(pointAt(p, way, dot(n, less(plane[0], p)), dot(n, way)));
      for (std::size_t j = 0; j < 3; ++j) {
        const Whole r = plane[j], other = less(plane[(j + 1) % 3], r), c = cross(way, other);
        if (dot(c, c) != 0 && dot(c, less(r, p)) == 0)
          offer(pointAt(p, way, dot(cross(less(r, p), other), c), dot(c, c)));
      }
    }
  }
  return all;
}

// Whether x is a point of the convex hull of the one or two points in `shared`.
bool isShared(const std::vector<Whole>& shared, const Fraction& x) {
  const auto from = [&](const Whole& p) { return less(x.top, times(p, x.bottom)); };
  if (shared.size() == 1)
    return from(shared[0]) == Whole{0, 0, 0};
  if (shared.size() != 2)
    return false;
  return cross(from(shared[0]), from(shared[1])) == Whole{0, 0, 0} &&
         dot(from(shared[0]), from(shared[1])) <= 0;
}

TEST(FaceContact, AgreesWithCornersByFractions) {
  Random random(7);
  std::map<std::size_t, std::array<int, 2>> seen; // points shared -> do not meet, meet
  for (int round = 0; round < 200000; ++round) {
    const std::size_t size = round % 2 == 0 ? 3 : 6;
    std::vector<Whole> whole; // different points: equal ones have one number
    std::array<std::uint32_t, 6> corner;
    const auto anyPoint = [&] {
      Whole p;
      for (Int& coordinate : p)
        coordinate = static_cast<Int>(random.below(size));
      if (round % 5 == 0)
        p[2] = 1; // all in one plane
      const auto known = std::find(whole.begin(), whole.end(), p);
      const auto number = static_cast<std::uint32_t>(known - whole.begin());
      if (known == whole.end())
        whole.push_back(p);
      return number;
    };
    for (std::uint32_t& c : corner)
      c = anyPoint();
    for (std::size_t k = 0; k < random.below(3); ++k) // some in common, anywhere
      corner[3 + random.below(3)] = corner[random.below(3)];
    std::vector<Vec3d> points;
    for (const Whole& p : whole)
      points.push_back({double(p[0]), double(p[1]), double(p[2])});
    const auto collinear = [&](const std::uint32_t* v) {
      return areCollinear(points[v[0]], points[v[1]], points[v[2]]);
    };
    std::vector<Whole> shared;
    for (std::size_t k = 0; k < 3; ++k)
      if (std::count(corner.begin() + 3, corner.end(), corner[k]) > 0)
        shared.push_back(whole[corner[k]]);
    if (collinear(&corner[0]) || collinear(&corner[3]) || shared.size() == 3)
      continue;
    const std::array<Whole, 3> a{whole[corner[0]], whole[corner[1]], whole[corner[2]]};
    const std::array<Whole, 3> b{whole[corner[3]], whole[corner[4]], whole[corner[5]]};
    bool expected = false;
    for (const Fraction& x : cornersInCommon(a, b))
      expected = expected || !isShared(shared, x);
    ASSERT_EQ(facesMeet(points, &corner[0], &corner[3]), expected) << round;
    ASSERT_EQ(facesMeet(points, &corner[3], &corner[0]), expected) << round;
    ++seen[shared.size()][expected];
  }
  for (std::size_t common = 0; common < 3; ++common)
    for (const int count : seen[common])
      EXPECT_GT(count, 1000) << common;
}

// A corner one unit in the last place before a face, in it, and behind it.
TEST(FaceContact, DecidesInTheLastPlace) {
  const double height = 1.0 / 3;
  for (const auto& [z, meets] :
       {std::pair(std::nextafter(height, 1), false), std::pair(height, true),
        std::pair(std::nextafter(height, 0), true)}) {
    const std::vector<Vec3d> points{{0, 0, height}, {1, 0, height}, {0, 1, height},
                                    {0.2, 0.2, z},  {0.2, 0.3, 1},  {0.3, 0.2, 1}};
    const std::uint32_t a[3] = {0, 1, 2}, b[3] = {3, 4, 5};
    EXPECT_EQ(facesMeet(points, a, b), meets) << z;
  }
}

} // namespace
} // namespace tetvdb
