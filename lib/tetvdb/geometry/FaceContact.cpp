// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/FaceContact.h"

#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace tetvdb {
namespace {

using Triangle = std::array<Vec3d, 3>;
using Sides = std::array<int, 3>; // of a triangle's corners relative to a plane

int sideOf(const Triangle& plane, const Vec3d& p) {
  return orientation(plane[0], plane[1], plane[2], p);
}

bool allOnOneSide(int a, int b, int c) {
  return a == b && b == c && a != 0;
}

// The axis of a projection in which the triangle does not become a line.
std::size_t axisToDrop(const Triangle& t) {
  const Vec3d n = cross(minus(t[1], t[0]), minus(t[2], t[0]));
  std::array<std::size_t, 3> axes{0, 1, 2};
  std::sort(axes.begin(), axes.end(),
            [&](std::size_t i, std::size_t j) { return std::abs(n[i]) > std::abs(n[j]); });
  for (const std::size_t axis : axes) {
    const std::size_t p = (axis + 1) % 3, q = (axis + 2) % 3;
    if (orientation(Vec2d{t[0][p], t[0][q]}, Vec2d{t[1][p], t[1][q]}, Vec2d{t[2][p], t[2][q]}) != 0)
      return axis;
  }
  return axes[0]; // collinear: violates the contract
}

// Predicates in the plane of a triangle, projected along the dropped axis.
struct Flat {
  std::size_t p, q;
  explicit Flat(const Triangle& t) {
    const std::size_t axis = axisToDrop(t);
    p = (axis + 1) % 3;
    q = (axis + 2) % 3;
  }
  int turn(const Vec3d& a, const Vec3d& b, const Vec3d& c) const {
    return orientation(Vec2d{a[p], a[q]}, Vec2d{b[p], b[q]}, Vec2d{c[p], c[q]});
  }
  bool contains(const Triangle& t, const Vec3d& x) const {
    const int a = turn(t[0], t[1], x), b = turn(t[1], t[2], x), c = turn(t[2], t[0], x);
    return std::min({a, b, c}) >= 0 || std::max({a, b, c}) <= 0;
  }
  // x is on the line through a and b.
  bool between(const Vec3d& a, const Vec3d& b, const Vec3d& x) const {
    return std::min(a[p], b[p]) <= x[p] && x[p] <= std::max(a[p], b[p]) &&
           std::min(a[q], b[q]) <= x[q] && x[q] <= std::max(a[q], b[q]);
  }
  bool segmentsMeet(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) const {
    const int ac = turn(a, b, c), ad = turn(a, b, d), ca = turn(c, d, a), cb = turn(c, d, b);
    if (ac * ad < 0 && ca * cb < 0)
      return true;
    return (ac == 0 && between(a, b, c)) || (ad == 0 && between(a, b, d)) ||
           (ca == 0 && between(c, d, a)) || (cb == 0 && between(c, d, b));
  }
  bool segmentMeets(const Triangle& t, const Vec3d& a, const Vec3d& b) const {
    if (contains(t, a) || contains(t, b))
      return true;
    for (std::size_t k = 0; k < 3; ++k)
      if (segmentsMeet(a, b, t[k], t[(k + 1) % 3]))
        return true;
    return false;
  }
};

// The closed segment from a to b, whose end points have these sides of the triangle's plane.
bool segmentMeets(const Triangle& t, const Vec3d& a, const Vec3d& b, int sideA, int sideB) {
  if (sideA * sideB > 0)
    return false;
  if (sideA == 0 && sideB == 0)
    return Flat(t).segmentMeets(t, a, b);
  if (sideA == 0 || sideB == 0)
    return Flat(t).contains(t, sideA == 0 ? a : b);
  const int x = orientation(a, b, t[0], t[1]);
  const int y = orientation(a, b, t[1], t[2]);
  if (x * y < 0)
    return false;
  const int z = orientation(a, b, t[2], t[0]);
  return std::min({x, y, z}) >= 0 || std::max({x, y, z}) <= 0;
}

// Whether the sectors at `tip`, of two directions each and below a half turn, intersect.
bool sectorsMeet(const Flat& flat, const Vec3d& tip, const Vec3d& a1, const Vec3d& a2,
                 const Vec3d& b1, const Vec3d& b2) {
  const auto contains = [&](const Vec3d& first, const Vec3d& last, const Vec3d& x) {
    const int turn = flat.turn(tip, first, last);
    return turn * flat.turn(tip, first, x) >= 0 && turn * flat.turn(tip, x, last) >= 0;
  };
  return contains(a1, a2, b1) || contains(a1, a2, b2) || contains(b1, b2, a1);
}

bool anyEdgeMeets(const Triangle& edges, const Sides& sides, const Triangle& t) {
  for (std::size_t k = 0; k < 3; ++k)
    if (segmentMeets(t, edges[k], edges[(k + 1) % 3], sides[k], sides[(k + 1) % 3]))
      return true;
  return false;
}

bool strangersMeet(const Triangle& a, const Triangle& b) {
  Sides ofB, ofA;
  for (std::size_t k = 0; k < 3; ++k)
    ofB[k] = sideOf(a, b[k]);
  if (allOnOneSide(ofB[0], ofB[1], ofB[2]))
    return false;
  for (std::size_t k = 0; k < 3; ++k)
    ofA[k] = sideOf(b, a[k]);
  if (allOnOneSide(ofA[0], ofA[1], ofA[2]))
    return false;
  return anyEdgeMeets(a, ofA, b) || anyEdgeMeets(b, ofB, a);
}

// Triangles with corner 0 in common. Any further intersection would extend, away from that corner,
// to the opposite edge of one of them.
bool meetBeyondCorner(const Triangle& a, const Triangle& b) {
  const int b1 = sideOf(a, b[1]), b2 = sideOf(a, b[2]);
  if (b1 * b2 > 0)
    return false;
  if (b1 == 0 && b2 == 0)
    return sectorsMeet(Flat(a), a[0], a[1], a[2], b[1], b[2]);
  const int a1 = sideOf(b, a[1]), a2 = sideOf(b, a[2]);
  if (a1 * a2 > 0)
    return false;
  return segmentMeets(b, a[1], a[2], a1, a2) || segmentMeets(a, b[1], b[2], b1, b2);
}

// Triangles with the edge from corner 0 to corner 1 in common.
bool meetBeyondEdge(const Triangle& a, const Triangle& b) {
  if (sideOf(a, b[2]) != 0)
    return false;
  const Flat flat(a);
  return flat.turn(a[0], a[1], a[2]) == flat.turn(a[0], a[1], b[2]);
}

} // namespace

bool facesMeet(const std::vector<Vec3d>& points, const std::uint32_t* a, const std::uint32_t* b) {
  // Common corners first, in the same order.
  std::array<std::uint32_t, 3> u{a[0], a[1], a[2]}, v{b[0], b[1], b[2]};
  std::size_t common = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto equal = std::find(v.begin() + static_cast<std::ptrdiff_t>(common), v.end(), u[i]);
    if (equal == v.end())
      continue;
    std::swap(*equal, v[common]);
    std::swap(u[i], u[common]);
    ++common;
  }
  const Triangle s{points[u[0]], points[u[1]], points[u[2]]};
  const Triangle t{points[v[0]], points[v[1]], points[v[2]]};
  switch (common) {
  case 0:
    return strangersMeet(s, t);
  case 1:
    return meetBeyondCorner(s, t);
  case 2:
    return meetBeyondEdge(s, t);
  default:
    return false;
  }
}

} // namespace tetvdb
