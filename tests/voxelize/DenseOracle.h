// SPDX-License-Identifier: Apache-2.0
//
// What voxelizing must give, from the definition alone and without the library's predicates: every
// voxel of every tet's box, the perturbed centre as a polynomial in e, 128-bit integers throughout.
#pragma once

#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/volume/Volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

namespace tetvdb::oracle {

__extension__ typedef __int128 Wide;
using Voxel = std::tuple<int, int, int>;

struct Owner {
  std::uint32_t tet;   // the lowest
  std::uint32_t count; // how many tets claim the voxel
};

// A number a0 + a1 e + a2 e^2 + a3 e^3 for e -> 0+.
struct Series {
  Wide a[4];
  int sign() const {
    for (Wide c : a)
      if (c != 0)
        return c > 0 ? 1 : -1;
    return 0;
  }
};

// Determinant of (q - p, r - p, c' - p) as a series.
inline Series side(const std::array<long long, 3>& p, const std::array<long long, 3>& q,
                   const std::array<long long, 3>& r, const std::array<long long, 3>& c) {
  Wide u[3], v[3], w[3];
  for (std::size_t k = 0; k < 3; ++k) {
    u[k] = q[k] - p[k];
    v[k] = r[k] - p[k];
    w[k] = c[k] - p[k];
  }
  const Wide minor[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                         u[0] * v[1] - u[1] * v[0]};
  return {{minor[0] * w[0] + minor[1] * w[1] + minor[2] * w[2], minor[0], minor[1], minor[2]}};
}

/// All owned voxels of the mesh.
inline std::map<Voxel, Owner> voxels(const TetMesh& mesh, const GridTransform& transform) {
  constexpr long long unit = 1 << 20;
  std::vector<std::array<long long, 3>> points;
  for (const Vec3d& p : mesh.points) {
    std::array<long long, 3> q{};
    for (std::size_t k = 0; k < 3; ++k)
      q[k] = std::llrint((p[k] - transform.origin[k]) / transform.voxelSize[k] * 1048576.0);
    points.push_back(q);
  }
  std::map<Voxel, Owner> result;
  for (std::uint32_t t = 0; t < mesh.tetCount(); ++t) {
    const auto& a = points[mesh.tets[4 * t]];
    const auto& b = points[mesh.tets[4 * t + 1]];
    const auto& c = points[mesh.tets[4 * t + 2]];
    const auto& d = points[mesh.tets[4 * t + 3]];
    long long low[3], high[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const long long min = std::min({a[k], b[k], c[k], d[k]});
      const long long max = std::max({a[k], b[k], c[k], d[k]});
      low[k] = (min - (((min % unit) + unit) % unit)) / unit; // one too low at times
      high[k] = (max - (((max % unit) + unit) % unit)) / unit;
    }
    for (long long x = low[0]; x <= high[0]; ++x)
      for (long long y = low[1]; y <= high[1]; ++y)
        for (long long z = low[2]; z <= high[2]; ++z) {
          const std::array<long long, 3> centre{x * unit, y * unit, z * unit};
          // The four sub-determinants have the sign of the whole, all of them.
          const int s0 = side(b, d, c, centre).sign(), s1 = side(a, c, d, centre).sign();
          const int s2 = side(a, d, b, centre).sign(), s3 = side(a, b, c, centre).sign();
          if (s0 == 0 || s0 != s1 || s1 != s2 || s2 != s3)
            continue;
          const Voxel key{int(x), int(y), int(z)};
          const auto [it, fresh] = result.try_emplace(key, Owner{t, 0});
          ++it->second.count;
        }
  }
  return result;
}

} // namespace tetvdb::oracle
