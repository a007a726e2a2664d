// SPDX-License-Identifier: Apache-2.0
//
// Tets and triangles against the cubes of voxels, in rational numbers. A tet is cut by the six
// planes of a cube into tets; no faces, and nothing of the library.
#pragma once

#include "tetvdb/mesh/TetMesh.h"

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

namespace tetvdb::oracle {

using Number = boost::multiprecision::cpp_rational;
using Point = std::array<Number, 3>;
using Tet = std::array<Point, 4>;

inline Number sixVolumes(const Tet& t) {
  std::array<Point, 3> e;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      e[i][k] = t[i + 1][k] - t[0][k];
  return abs(Number(e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                    e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                    e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])));
}

// The part of a tet with side * (p[axis] - c) >= 0, as tets.
inline void keep(const Tet& t, std::size_t axis, const Number& c, int side, std::vector<Tet>& out) {
  std::vector<std::size_t> in, off;
  std::array<Number, 4> s;
  for (std::size_t i = 0; i < 4; ++i) {
    s[i] = (t[i][axis] - c) * side;
    (s[i] >= 0 ? in : off).push_back(i);
  }
  const auto between = [&](std::size_t i, std::size_t k) {
    const Number u = s[i] / (s[i] - s[k]);
    Point p;
    for (std::size_t a = 0; a < 3; ++a)
      p[a] = t[i][a] + u * (t[k][a] - t[i][a]);
    return p;
  };
  if (in.size() == 4) {
    out.push_back(t);
  } else if (in.size() == 1) {
    out.push_back(
        {t[in[0]], between(in[0], off[0]), between(in[0], off[1]), between(in[0], off[2])});
  } else if (in.size() == 3) { // a wedge: the kept corners and what faces them
    const Point a = between(in[0], off[0]), b = between(in[1], off[0]), d = between(in[2], off[0]);
    out.push_back({t[in[0]], t[in[1]], t[in[2]], a});
    out.push_back({t[in[1]], t[in[2]], a, b});
    out.push_back({t[in[2]], a, b, d});
  } else if (in.size() == 2) { // a wedge between two triangles
    const Point a0 = between(in[0], off[0]), a1 = between(in[0], off[1]),
                b0 = between(in[1], off[0]), b1 = between(in[1], off[1]);
    out.push_back({t[in[0]], a0, a1, t[in[1]]});
    out.push_back({a0, a1, t[in[1]], b0});
    out.push_back({a1, t[in[1]], b0, b1});
  }
}

inline Number filled(const Tet& tet, const std::array<int, 3>& voxel) {
  std::vector<Tet> parts{tet};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {1, -1}) {
      std::vector<Tet> kept;
      for (const Tet& part : parts)
        keep(part, axis, Number(2 * voxel[axis] - side, 2), side, kept);
      parts = kept;
    }
  Number sum = 0;
  for (const Tet& part : parts)
    sum += sixVolumes(part);
  return sum / 6;
}

// Of all tets of a mesh whose coordinates are multiples of 1/16 voxel.
inline std::map<std::array<int, 3>, Number> filled(const TetMesh& mesh) {
  std::map<std::array<int, 3>, Number> result;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    Tet tet;
    Vec3d low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const double c = mesh.points[mesh.tets[4 * t + i]][k];
        tet[i][k] = Number(static_cast<long long>(c * 16), 16);
        low[k] = std::min(low[k], c);
        high[k] = std::max(high[k], c);
      }
    const auto first = [&](std::size_t k) { return static_cast<int>(std::floor(low[k])); };
    const auto last = [&](std::size_t k) { return static_cast<int>(std::ceil(high[k])); };
    for (int x = first(0); x <= last(0); ++x)
      for (int y = first(1); y <= last(1); ++y)
        for (int z = first(2); z <= last(2); ++z) {
          const Number share = filled(tet, {x, y, z});
          if (share > 0)
            result[{x, y, z}] += share;
        }
  }
  return result;
}

/// Whether a triangle passes through the open cube of a voxel. What it has within the closed cube
/// is convex, and the mean of its corners is inside the cube unless all of it lies on a side.
inline bool passesThrough(const std::array<Point, 3>& triangle, const std::array<int, 3>& voxel) {
  std::vector<Point> part(triangle.begin(), triangle.end());
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {1, -1}) {
      const Number c(2 * voxel[axis] - side, 2);
      std::vector<Point> kept;
      for (std::size_t i = 0; i < part.size(); ++i) {
        const Point &p = part[i], &q = part[(i + 1) % part.size()];
        const Number sp = (p[axis] - c) * side, sq = (q[axis] - c) * side;
        if (sp >= 0)
          kept.push_back(p);
        if ((sp < 0 && sq > 0) || (sp > 0 && sq < 0)) {
          const Number u = sp / (sp - sq);
          Point r;
          for (std::size_t a = 0; a < 3; ++a)
            r[a] = p[a] + u * (q[a] - p[a]);
          kept.push_back(r);
        }
      }
      part = kept;
    }
  if (part.empty())
    return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Number sum = 0;
    for (const Point& p : part)
      sum += p[axis];
    const Number off = sum / static_cast<long long>(part.size()) - voxel[axis];
    if (!(off > Number(-1, 2) && off < Number(1, 2)))
      return false;
  }
  return true;
}

} // namespace tetvdb::oracle
