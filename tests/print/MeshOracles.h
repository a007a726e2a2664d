// SPDX-License-Identifier: Apache-2.0
//
// Judges of prepared solids that share no code with the library.
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

namespace tetvdb::oracles {

/// Whether every edge is run along once in each direction.
inline bool isClosedManifold(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t a = mesh.triangles[i];
    const std::uint32_t b = mesh.triangles[i % 3 == 2 ? i - 2 : i + 1];
    if (a == b || ++directed[{a, b}] > 1)
      return false;
  }
  return std::all_of(directed.begin(), directed.end(), [&](const auto& edge) {
    return directed.count({edge.first.second, edge.first.first}) == 1;
  });
}

using Point = std::array<double, 3>;

inline Point sub(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline double inner(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Point along(const Point& a, const Point& d, double t) {
  return {a[0] + t * d[0], a[1] + t * d[1], a[2] + t * d[2]};
}

/// From a point to a segment.
inline double toSegment(const Point& p, const Point& a, const Point& b) {
  const Point d = sub(b, a);
  const double square = inner(d, d);
  const double t = square > 0 ? std::clamp(inner(sub(p, a), d) / square, 0.0, 1.0) : 0;
  const Point off = sub(p, along(a, d, t));
  return std::sqrt(inner(off, off));
}

/// From a point to a triangle: to its plane where the point stands over it, else to an edge.
inline double toTriangle(const Point& p, const std::array<Point, 3>& t) {
  double minimum =
      std::min({toSegment(p, t[0], t[1]), toSegment(p, t[1], t[2]), toSegment(p, t[2], t[0])});
  const Point u = sub(t[1], t[0]), v = sub(t[2], t[0]), w = sub(p, t[0]);
  const double uu = inner(u, u), uv = inner(u, v), vv = inner(v, v), wu = inner(w, u),
               wv = inner(w, v), det = uu * vv - uv * uv;
  if (det > 0) {
    const double s = (vv * wu - uv * wv) / det, r = (uu * wv - uv * wu) / det;
    if (s >= 0 && r >= 0 && s + r <= 1) {
      const Point off = sub(p, along(along(t[0], u, s), v, r));
      minimum = std::min(minimum, std::sqrt(inner(off, off)));
    }
  }
  return minimum;
}

/// Between segments, by their closest points (Ericson, Real-Time Collision Detection, 5.1.9).
inline double betweenSegments(const Point& p, const Point& q, const Point& a, const Point& b) {
  const Point d = sub(q, p), e = sub(b, a), r = sub(p, a);
  const double dd = inner(d, d), ee = inner(e, e), de = inner(d, e), dr = inner(d, r),
               er = inner(e, r), det = dd * ee - de * de;
  double s = det > 0 ? std::clamp((de * er - dr * ee) / det, 0.0, 1.0) : 0;
  double t = ee > 0 ? (de * s + er) / ee : 0;
  t = std::clamp(t, 0.0, 1.0);
  s = dd > 0 ? std::clamp((de * t - dr) / dd, 0.0, 1.0) : 0;
  const Point off = sub(along(p, d, s), along(a, e, t));
  return std::sqrt(inner(off, off));
}

inline std::array<Point, 3> cornersOf(const TriangleMesh& mesh, std::size_t face) {
  return {mesh.points[mesh.triangles[3 * face]], mesh.points[mesh.triangles[3 * face + 1]],
          mesh.points[mesh.triangles[3 * face + 2]]};
}

/// The minimum distance from every `step`-th face of `from` to `to`: triangles that do not cross
/// are nearest at a corner of one or at two edges.
inline double distanceBetween(const TriangleMesh& from, const TriangleMesh& to,
                              std::size_t step = 1) {
  double minimum = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < from.triangleCount(); i += step) {
    const std::array<Point, 3> s = cornersOf(from, i);
    for (std::size_t j = 0; j < to.triangleCount(); ++j) {
      const std::array<Point, 3> t = cornersOf(to, j);
      bool isFar = false; // by boxes
      for (std::size_t k = 0; k < 3; ++k)
        isFar =
            isFar ||
            std::min({s[0][k], s[1][k], s[2][k]}) - minimum >
                std::max({t[0][k], t[1][k], t[2][k]}) ||
            std::max({s[0][k], s[1][k], s[2][k]}) + minimum < std::min({t[0][k], t[1][k], t[2][k]});
      if (isFar)
        continue;
      for (std::size_t k = 0; k < 3; ++k) {
        minimum = std::min({minimum, toTriangle(s[k], t), toTriangle(t[k], s)});
        for (std::size_t l = 0; l < 3; ++l)
          minimum = std::min(minimum, betweenSegments(s[k], s[(k + 1) % 3], t[l], t[(l + 1) % 3]));
      }
    }
  }
  return minimum;
}

} // namespace tetvdb::oracles
