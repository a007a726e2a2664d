// SPDX-License-Identifier: Apache-2.0
//
// The point-in-tetrahedron test of "Robust Voxelization and Visualization by Improved Tetrahedral
// Mesh Generation" (Chen, Tai, Chen, Ouhyoung), section 4, there named after Philipp B.: P lies in
// the interior of ABCD if and only if the determinants of (b c d), (a c d), (a b d), (a b c) have
// the signs + - + - or - + - +, where a = A - P and so on.
//
// It is kept as a baseline and as a cross-check: off ties it agrees with ownsVoxel(); a centre on a
// face, an edge or a vertex it gives to no tet at all, which is why voxelizing does not use it.
#pragma once

#include "tetvdb/geometry/Exact.h"

#include <array>

namespace tetvdb {

/// The paper's test in number type T (double as the paper runs it, Int128 for exactness).
template <typename T>
struct PhilippB {
  using Point = std::array<T, 3>;

  /// Determinant of the matrix with rows u, v, w.
  static T determinant(const Point& u, const Point& v, const Point& w) {
    return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
  }

  /// D_a, D_b, D_c, D_d of the paper's theorem 1.
  static std::array<T, 4> determinants(const std::array<Point, 4>& tet, const Point& p) {
    std::array<Point, 4> to{};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        to[i][k] = tet[i][k] - p[k];
    return {determinant(to[1], to[2], to[3]), determinant(to[0], to[2], to[3]),
            determinant(to[0], to[1], to[3]), determinant(to[0], to[1], to[2])};
  }

  /// Whether p is in the interior of the tet, of either orientation.
  static bool inside(const std::array<Point, 4>& tet, const Point& p) {
    const std::array<T, 4> d = determinants(tet, p);
    return (d[0] > 0 && d[1] < 0 && d[2] > 0 && d[3] < 0) ||
           (d[0] < 0 && d[1] > 0 && d[2] < 0 && d[3] > 0);
  }
};

} // namespace tetvdb
