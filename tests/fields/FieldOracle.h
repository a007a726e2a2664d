// SPDX-License-Identifier: Apache-2.0
//
// What a voxel's value must be: its owner by brute force (voxelize/DenseOracle.h), weights as
// ratios of 128-bit determinants, sums in long double.
#pragma once

#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/volume/Volume.h"
#include "voxelize/DenseOracle.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace tetvdb::oracle {

inline std::array<long long, 3> snapped(const Vec3d& p, const GridTransform& transform) {
  std::array<long long, 3> q{};
  for (std::size_t k = 0; k < 3; ++k)
    q[k] = std::llrint((p[k] - transform.origin[k]) / transform.voxelSize[k] * 1048576.0);
  return q;
}

inline Wide determinant(const std::array<long long, 3>& a, const std::array<long long, 3>& b,
                        const std::array<long long, 3>& c, const std::array<long long, 3>& d) {
  return side(a, b, c, d).a[0];
}

/// Weights of the tet's four corners, in its own order, at the centre of a voxel.
inline std::array<long double, 4> weights(const TetMesh& mesh, const GridTransform& transform,
                                          std::uint32_t tet, const Voxel& voxel) {
  std::array<std::array<long long, 3>, 4> v;
  for (std::size_t i = 0; i < 4; ++i)
    v[i] = snapped(mesh.points[mesh.tets[4 * tet + i]], transform);
  const std::array<long long, 3> c{(long long)std::get<0>(voxel) * (1LL << 20),
                                   (long long)std::get<1>(voxel) * (1LL << 20),
                                   (long long)std::get<2>(voxel) * (1LL << 20)};
  const auto whole = static_cast<long double>(determinant(v[0], v[1], v[2], v[3]));
  return {static_cast<long double>(determinant(c, v[1], v[2], v[3])) / whole,
          static_cast<long double>(determinant(v[0], c, v[2], v[3])) / whole,
          static_cast<long double>(determinant(v[0], v[1], c, v[3])) / whole,
          static_cast<long double>(determinant(v[0], v[1], v[2], c)) / whole};
}

/// Component `c` of a point array, interpolated.
inline double interpolated(const TetMesh& mesh, const GridTransform& transform, std::uint32_t tet,
                           const Voxel& voxel, const Attribute& array, std::uint32_t c = 0) {
  const auto w = weights(mesh, transform, tet, voxel);
  long double sum = 0;
  for (std::size_t i = 0; i < 4; ++i)
    sum += w[i] * array.number(mesh.tets[4 * tet + i], c);
  return static_cast<double>(sum);
}

} // namespace tetvdb::oracle
