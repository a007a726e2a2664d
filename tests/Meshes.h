// SPDX-License-Identifier: Apache-2.0
//
// Tet meshes made for tests and benchmarks.
#pragma once

#include "tetvdb/mesh/TetMesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <random>
#include <utility>

namespace tetvdb::meshes {

/// Numbers that are the same on every standard library.
class Random {
public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// Uniform in [0, 1).
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  std::size_t below(std::size_t n) {
    return std::min(static_cast<std::size_t>(unit() * static_cast<double>(n)), n - 1);
  }

private:
  std::mt19937_64 engine_;
};

/// Kuhn's subdivision of nx x ny x nz cubes, six tets each, on [0, nx] x [0, ny] x [0, nz]:
/// neighbours agree on their faces, all tets are positive.
inline TetMesh kuhnGrid(int nx, int ny, int nz) {
  TetMesh mesh;
  const auto index = [&](int x, int y, int z) {
    return static_cast<std::uint32_t>((x * (ny + 1) + y) * (nz + 1) + z);
  };
  for (int x = 0; x <= nx; ++x)
    for (int y = 0; y <= ny; ++y)
      for (int z = 0; z <= nz; ++z)
        mesh.points.push_back({double(x), double(y), double(z)});
  constexpr int paths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int x = 0; x < nx; ++x)
    for (int y = 0; y < ny; ++y)
      for (int z = 0; z < nz; ++z)
        for (int p = 0; p < 6; ++p) {
          int at[3] = {x, y, z};
          std::uint32_t v[4] = {index(x, y, z), 0, 0, 0};
          for (int k = 0; k < 3; ++k) {
            ++at[paths[p][k]];
            v[k + 1] = index(at[0], at[1], at[2]);
          }
          if (p >= 3)
            std::swap(v[2], v[3]); // odd permutations
          mesh.tets.insert(mesh.tets.end(), v, v + 4);
        }
  mesh.cellCount = mesh.tetCount();
  return mesh;
}

/// p -> f(p) for every point.
template <typename Map>
TetMesh mapped(TetMesh mesh, const Map& f) {
  for (Vec3d& p : mesh.points)
    p = f(p);
  return mesh;
}

inline TetMesh scaled(TetMesh mesh, double s, const Vec3d& shift = {0, 0, 0}) {
  return mapped(std::move(mesh), [&](const Vec3d& p) {
    return Vec3d{p[0] * s + shift[0], p[1] * s + shift[1], p[2] * s + shift[2]};
  });
}

/// Moves every point that is not on the box's surface by up to `amount` cells.
inline TetMesh jittered(TetMesh mesh, double amount, std::uint64_t seed, bool surfaceToo = false) {
  Random random(seed);
  Vec3d top{0, 0, 0};
  for (const Vec3d& p : mesh.points)
    for (std::size_t k = 0; k < 3; ++k)
      top[k] = std::max(top[k], p[k]);
  for (Vec3d& p : mesh.points)
    for (std::size_t k = 0; k < 3; ++k) {
      const double move = random.between(-amount, amount);
      if (surfaceToo || (p[k] > 0 && p[k] < top[k]))
        p[k] += move;
    }
  return mesh;
}

/// A ball of 6 n^3 tets: the cube pulled onto spheres shell by shell.
inline TetMesh ball(int n, double radius, const Vec3d& centre) {
  return mapped(kuhnGrid(n, n, n), [&](const Vec3d& p) {
    Vec3d q{2 * p[0] / n - 1, 2 * p[1] / n - 1, 2 * p[2] / n - 1};
    const double shell = std::max({std::abs(q[0]), std::abs(q[1]), std::abs(q[2])});
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    const double s = length > 0 ? shell / length * radius : 0;
    return Vec3d{centre[0] + q[0] * s, centre[1] + q[1] * s, centre[2] + q[2] * s};
  });
}

/// Unconnected tets of mixed orientation with corners in [0, size]^3; `flat` of them have no
/// volume.
inline TetMesh soup(std::size_t count, double size, double tetSize, std::uint64_t seed,
                    std::size_t flat = 0) {
  Random random(seed);
  TetMesh mesh;
  for (std::size_t t = 0; t < count + flat; ++t) {
    const Vec3d o{random.between(0, size), random.between(0, size), random.between(0, size)};
    for (int i = 0; i < 4; ++i) {
      mesh.tets.push_back(static_cast<std::uint32_t>(mesh.points.size()));
      Vec3d p = o;
      for (double& c : p)
        c += random.between(-tetSize, tetSize);
      mesh.points.push_back(p);
    }
    if (t >= count) {
      auto last = mesh.points.end();
      *(last - 1) = *(last - 2);
    }
  }
  mesh.cellCount = mesh.tetCount();
  return mesh;
}

/// Coordinates rounded to multiples of `step`: ties in plenty.
inline TetMesh rounded(TetMesh mesh, double step) {
  return mapped(std::move(mesh), [&](const Vec3d& p) {
    return Vec3d{std::round(p[0] / step) * step, std::round(p[1] / step) * step,
                 std::round(p[2] / step) * step};
  });
}

/// The same mesh with its points and tets in another order, corners turned but orientation kept;
/// tetOf[i] is the old number of tet i.
inline TetMesh shuffled(const TetMesh& mesh, std::uint64_t seed,
                        std::vector<std::uint32_t>* tetOf = nullptr) {
  Random random(seed);
  const auto permutation = [&](std::size_t n) {
    std::vector<std::uint32_t> p(n);
    std::iota(p.begin(), p.end(), 0u);
    for (std::size_t i = n; i > 1; --i)
      std::swap(p[i - 1], p[random.below(i)]);
    return p;
  };
  const auto pointOf = permutation(mesh.points.size());
  const auto tets = permutation(mesh.tetCount());
  TetMesh result;
  std::vector<std::uint32_t> newIndex(mesh.points.size());
  for (std::size_t i = 0; i < pointOf.size(); ++i) {
    newIndex[pointOf[i]] = static_cast<std::uint32_t>(i);
    result.points.push_back(mesh.points[pointOf[i]]);
  }
  for (std::uint32_t t : tets) {
    std::uint32_t v[4];
    for (std::size_t k = 0; k < 4; ++k)
      v[k] = newIndex[mesh.tets[4 * t + k]];
    const std::size_t turn = random.below(3);
    for (std::size_t k = 0; k < turn; ++k) {
      std::swap(v[0], v[1]);
      std::swap(v[1], v[2]);
    }
    result.tets.insert(result.tets.end(), v, v + 4);
  }
  result.cellCount = result.tetCount();
  if (tetOf != nullptr)
    *tetOf = tets;
  return result;
}

/// Both meshes in one, nothing welded.
inline TetMesh joined(TetMesh a, const TetMesh& b) {
  const auto offset = static_cast<std::uint32_t>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (std::uint32_t v : b.tets)
    a.tets.push_back(v + offset);
  a.cellCount = a.tetCount();
  return a;
}

} // namespace tetvdb::meshes
