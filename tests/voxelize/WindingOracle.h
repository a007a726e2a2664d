// SPDX-License-Identifier: Apache-2.0
//
// The winding number of triangles on the lattice, summed one by one.
#pragma once

#include "tetvdb/geometry/FillHoles.h"

#include <cmath>
#include <vector>

namespace tetvdb::test {

/// The definition, in long double (Van Oosterom and Strackee 1983). `voxel`: in index space.
inline double windingOf(const std::vector<FillTriangle>& triangles, const Vec3d& voxel) {
  long double total = 0;
  for (const FillTriangle& t : triangles) {
    const LatticePoint* corners[3] = {&t.a, &t.b, &t.c};
    long double v[3][3], l[3];
    for (int i = 0; i < 3; ++i) {
      v[i][0] = corners[i]->x - voxel[0] * static_cast<double>(kUnitsPerVoxel);
      v[i][1] = corners[i]->y - voxel[1] * static_cast<double>(kUnitsPerVoxel);
      v[i][2] = corners[i]->z - voxel[2] * static_cast<double>(kUnitsPerVoxel);
      l[i] = std::sqrt(v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]);
    }
    const auto dot = [&](int i, int j) {
      return v[i][0] * v[j][0] + v[i][1] * v[j][1] + v[i][2] * v[j][2];
    };
    const long double det = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) -
                            v[0][1] * (v[1][0] * v[2][2] - v[1][2] * v[2][0]) +
                            v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
    total += t.weight * 2 *
             std::atan2(det, l[0] * l[1] * l[2] + dot(0, 1) * l[2] + dot(1, 2) * l[0] +
                                 dot(2, 0) * l[1]);
  }
  return static_cast<double>(total / (4 * 3.14159265358979323846L));
}

} // namespace tetvdb::test
