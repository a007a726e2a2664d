// SPDX-License-Identifier: Apache-2.0
//
// Meshes to test with that no code under test has made, and what must hold of any mesh.
#pragma once

#include "tetvdb/geometry/Exact.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace tetvdb {

using FaceKey = std::array<std::uint32_t, 3>;

inline FaceKey keyOfFace(const std::array<std::uint32_t, 4>& corners, unsigned localFace) {
  FaceKey key{};
  for (unsigned i = 0, k = 0; i < 4; ++i)
    if (i != localFace)
      key[k++] = corners[i];
  std::sort(key.begin(), key.end());
  return key;
}

/// Neighbours by a map of faces, the chains of faces by `winding`, the winding number of each tet.
inline void connect(TetComplex& complex, const std::vector<Chain>& winding) {
  std::map<FaceKey, std::pair<std::uint32_t, unsigned>> open;
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t) {
    auto& tet = complex.tets[t];
    tet.neighbours.fill(TetComplex::kOutside);
    tet.chains.fill(0);
    tet.tracked.fill(false);
    tet.energy = 0;
    tet.mark = 0;
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      complex.points[tet.corners[localFace]].tet = t;
      const auto [found, isNew] = open.insert({keyOfFace(tet.corners, localFace), {t, localFace}});
      if (isNew)
        continue;
      const auto [other, otherFace] = found->second;
      tet.neighbours[localFace] = other;
      complex.tets[other].neighbours[otherFace] = t;
      tet.chains[localFace] = winding[t] - winding[other];
      complex.tets[other].chains[otherFace] = winding[other] - winding[t];
      tet.tracked[localFace] = complex.tets[other].tracked[otherFace] =
          winding[other] != winding[t];
      open.erase(found);
    }
  }
}

/// Six times the volume of all tets; every one has to be positive.
inline Int128 volumeOf(const TetComplex& complex) {
  Int128 sum = 0;
  for (const auto& tet : complex.tets) {
    if (!tet.exists())
      continue;
    const auto& o = complex.at(tet.corners[0]);
    Int128 d[3][3];
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        d[i][axis] = static_cast<Int128>(
            static_cast<std::int64_t>(complex.at(tet.corners[i + 1])[axis] - o[axis]));
    const Int128 six = d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) -
                       d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
                       d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
    EXPECT_TRUE(six > 0);
    sum += six;
  }
  return sum;
}

/// Cubes of side `step`, `cells` a side, each cut into six tets along a diagonal; inner points are
/// perturbed by up to `shake` of the step. `winding` says what the winding number is at a tet's
/// centre; the box's corners have the coordinates 0 and cells * step.
inline TetComplex cubeMesh(int cells, double step, double shake,
                           const std::function<Chain(const Vec3d&)>& winding,
                           std::uint64_t seed = 1) {
  TetComplex complex;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> offset(-shake * step, shake * step);
  const int side = cells + 1;
  const auto number = [&](int x, int y, int z) {
    return static_cast<std::uint32_t>((z * side + y) * side + x);
  };
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const bool isInner = x > 0 && y > 0 && z > 0 && x < cells && y < cells && z < cells;
        Vec3d at{x * step, y * step, z * step};
        for (double& coordinate : at)
          coordinate += offset(random) * (isInner ? 1 : 0);
        complex.addPoint(roundToLattice(at));
        complex.points.back().fixed = !isInner;
      }
  std::vector<Chain> windings;
  for (int z = 0; z < cells; ++z)
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x) {
        std::array<int, 3> axes{0, 1, 2};
        do {
          std::array<int, 3> at{x, y, z};
          TetComplex::Tet tet{};
          tet.corners[0] = number(at[0], at[1], at[2]);
          for (std::size_t i = 0; i < 3; ++i) {
            ++at[static_cast<std::size_t>(axes[i])];
            tet.corners[i + 1] = number(at[0], at[1], at[2]);
          }
          if (!complex.isPositive(tet.corners))
            std::swap(tet.corners[2], tet.corners[3]);
          Vec3d centre{0, 0, 0};
          for (const std::uint32_t corner : tet.corners)
            for (std::size_t axis = 0; axis < 3; ++axis)
              centre[axis] += complex.at(corner)[axis] / 4;
          windings.push_back(winding(centre));
          complex.tets.push_back(tet);
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
  connect(complex, windings);
  // Tets overlap if points are moved too far.
  const auto size = static_cast<std::int64_t>(cells * step);
  EXPECT_TRUE(volumeOf(complex) == static_cast<Int128>(6) * size * size * size);
  return complex;
}

/// Winding number 1 in a ball, 0 around it.
inline std::function<Chain(const Vec3d&)> ballAt(const Vec3d& centre, double radius) {
  return [centre, radius](const Vec3d& p) {
    double square = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      square += (p[axis] - centre[axis]) * (p[axis] - centre[axis]);
    return square < radius * radius ? 1 : 0;
  };
}

/// The tracked faces, each once, seen from the side where its chain is positive.
struct TrackedFaces {
  std::vector<Vec3d> points; ///< of the complex
  std::vector<std::array<std::uint32_t, 3>> faces;
  std::vector<Chain> chains;
};

inline TrackedFaces trackedFaces(const TetComplex& complex) {
  TrackedFaces result;
  for (const auto& point : complex.points)
    result.points.push_back(point.at);
  for (const auto& tet : complex.tets) {
    if (!tet.exists())
      continue;
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      const auto& f = kFaceCorners[localFace];
      const std::array<std::uint32_t, 3> face{tet.corners[f[0]], tet.corners[f[1]],
                                              tet.corners[f[2]]};
      // Of the two sides the positive one; of chain 0 the one that starts lower.
      const bool mine =
          tet.chains[localFace] != 0
              ? tet.chains[localFace] > 0
              : tet.neighbours[localFace] > static_cast<std::uint32_t>(&tet - complex.tets.data());
      if (tet.tracked[localFace] && mine) {
        result.faces.push_back(face);
        result.chains.push_back(tet.chains[localFace]);
      }
    }
  }
  return result;
}

/// Every edge has faces whose chains leave nothing over; an even number of them, unless faces lie
/// on one another.
inline void expectClosed(const TrackedFaces& surface, bool folded = false) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<int, Chain>> edges;
  for (std::size_t f = 0; f < surface.faces.size(); ++f)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = surface.faces[f][i], b = surface.faces[f][(i + 1) % 3];
      auto& edge = edges[{std::min(a, b), std::max(a, b)}];
      ++edge.first;
      edge.second += a < b ? surface.chains[f] : -surface.chains[f];
    }
  for (const auto& [edge, sum] : edges) {
    EXPECT_TRUE(folded || sum.first % 2 == 0) << edge.first << ' ' << edge.second;
    EXPECT_EQ(sum.second, 0) << edge.first << ' ' << edge.second;
  }
}

/// Vertices less edges plus faces of the surface: 2 for a sphere.
inline long eulerNumber(const TrackedFaces& surface) {
  std::set<std::uint32_t> vertices;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& face : surface.faces)
    for (std::size_t i = 0; i < 3; ++i) {
      vertices.insert(face[i]);
      edges.insert({std::min(face[i], face[(i + 1) % 3]), std::max(face[i], face[(i + 1) % 3])});
    }
  return static_cast<long>(vertices.size()) - static_cast<long>(edges.size()) +
         static_cast<long>(surface.faces.size());
}

} // namespace tetvdb
