// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/geometry/LocalExpansion.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

using Function = std::function<double(const Vec3d&)>;

const double kHalfSide = 1 / std::sqrt(3.0); // of a cube in a ball of radius 1

Expansion expansionOf(const Function& f) {
  Expansion e;
  for (std::size_t i = 0; i < kExpansionPoints; ++i)
    e.values[i] = f(expansionDirections()[i]);
  return e;
}

// Powers of (w . x) with w . w = 0 are harmonic.
Function anyHarmonic(meshes::Random& random, int degree) {
  std::vector<std::array<std::complex<double>, 3>> ways;
  for (int i = 0; i < 3; ++i) {
    const std::complex<double> a(random.between(-1, 1), random.between(-1, 1)),
        b(random.between(-1, 1), random.between(-1, 1));
    ways.push_back({a, b, std::sqrt(-a * a - b * b)});
  }
  return [ways, degree](const Vec3d& x) {
    std::complex<double> sum = 0;
    for (const auto& w : ways)
      sum += std::pow(w[0] * x[0] + w[1] * x[1] + w[2] * x[2], degree);
    return sum.real();
  };
}

Vec3d octantCentre(std::size_t o) {
  return {(o & 4) != 0 ? kHalfSide / 2 : -kHalfSide / 2,
          (o & 2) != 0 ? kHalfSide / 2 : -kHalfSide / 2,
          (o & 1) != 0 ? kHalfSide / 2 : -kHalfSide / 2};
}

TEST(LocalExpansion, HarmonicPolynomialsAreExact) {
  meshes::Random random(1);
  for (int degree = 0; degree <= kExpansionDegree; ++degree)
    for (int i = 0; i < 5; ++i) {
      const Function f = anyHarmonic(random, degree);
      const Expansion e = expansionOf(f);
      VoxelValues voxels;
      expandAtVoxels(e, voxels);
      for (std::size_t v = 0; v < voxels.size(); ++v) {
        const auto at = [](std::size_t k) { return (double(k) - 1.5) / 2 * kHalfSide; };
        EXPECT_NEAR(voxels[v], f({at(v / 16), at(v / 4 % 4), at(v % 4)}), 1e-12);
      }
      for (std::size_t o = 0; o < 8; ++o) {
        Expansion part;
        expandInOctant(e, o, part);
        for (std::size_t j = 0; j < kExpansionPoints; ++j) {
          Vec3d x = octantCentre(o);
          for (std::size_t k = 0; k < 3; ++k)
            x[k] += expansionDirections()[j][k] / 2;
          EXPECT_NEAR(part.values[j], f(x), 1e-12);
        }
        for (std::size_t j = kExpansionPoints; j < part.values.size(); ++j)
          EXPECT_EQ(part.values[j], 0);
      }
    }
}

TEST(LocalExpansion, RangeBoundsTheExpansion) {
  meshes::Random random(2);
  double sharpest = 0;
  for (int i = 0; i < 200; ++i) {
    Function f = anyHarmonic(random, i % 6);
    if (i % 3 == 0) {
      const Function other = anyHarmonic(random, 1);
      f = [f, other](const Vec3d& x) { return f(x) + 4 * other(x); };
    }
    for (const double share : {0.5, 0.95, 1.0}) {
      const ExpansionRange range = rangeOf(expansionOf(f), share);
      EXPECT_NEAR(range.midpoint, f({0, 0, 0}), 1e-12);
      double max = 0;
      for (int k = 0; k < 200; ++k) {
        Vec3d x{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
        const double size = std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        for (double& c : x)
          c *= share / size;
        max = std::max(max, std::abs(f(x) - range.midpoint));
      }
      EXPECT_LE(max, range.change + 1e-12);
      if (range.change > 0)
        sharpest = std::max(sharpest, max / range.change);
    }
  }
  EXPECT_GT(sharpest, 0.9);
}

// Dipoles, which small triangles are like, and large triangles by many of them.
TEST(LocalExpansion, ErrorIsBounded) {
  meshes::Random random(3);
  double sharpest = 0;
  for (int i = 0; i < 300; ++i) {
    const double distance = random.between(1.2, 6), side = i % 2 == 0 ? 0.01 : 4;
    std::vector<std::pair<Vec3d, Vec3d>> dipoles;
    const int n = i % 2 == 0 ? 1 : 60;
    Vec3d normal{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    if (n > 1)
      normal = {0, 0, 1};
    const double size =
        std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (double& c : normal)
      c *= side * side / (n * n) / size;
    for (int u = 0; u < n; ++u)
      for (int v = 0; v < n; ++v)
        dipoles.push_back(
            {{side * (u + 0.5) / n - side / 2, side * (v + 0.5) / n - side / 2, distance}, normal});
    const Function f = [&](const Vec3d& x) {
      double sum = 0;
      for (const auto& [place, area] : dipoles) {
        const Vec3d q{place[0] - x[0], place[1] - x[1], place[2] - x[2]};
        const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
        sum += (area[0] * q[0] + area[1] * q[1] + area[2] * q[2]) / (square * std::sqrt(square));
      }
      return sum;
    };
    const double bound = expansionError(distance, side * side);
    VoxelValues voxels;
    expandAtVoxels(expansionOf(f), voxels);
    for (std::size_t v = 0; v < voxels.size(); ++v) {
      const auto at = [](std::size_t k) { return (double(k) - 1.5) / 2 * kHalfSide; };
      const double error = std::abs(voxels[v] - f({at(v / 16), at(v / 4 % 4), at(v % 4)}));
      EXPECT_LE(error, bound + 1e-12);
      sharpest = std::max(sharpest, error / bound);
    }
  }
  EXPECT_GT(sharpest, 0.01) << "the bound is far from sharp";
}

} // namespace
} // namespace tetvdb
