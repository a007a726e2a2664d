// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/LocalExpansion.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace tetvdb {
namespace {

// V. I. Lebedev, "Quadratures on a sphere", USSR Computational Mathematics and Mathematical Physics
// 16 (1976): the rule of order 11. Points are all permutations and signs of (1, 0, 0), (1, 1, 0),
// (1, 1, 1) and (1, 1, 3).
ExpansionRule lebedevRule() {
  ExpansionRule rule{};
  std::size_t count = 0;
  for (int x = -3; x <= 3; ++x)
    for (int y = -3; y <= 3; ++y)
      for (int z = -3; z <= 3; ++z) {
        std::array<int, 3> sizes{std::abs(x), std::abs(y), std::abs(z)};
        std::sort(sizes.begin(), sizes.end());
        double weight = 0;
        if (sizes == std::array<int, 3>{0, 0, 1})
          weight = 4.0 / 315;
        else if (sizes == std::array<int, 3>{0, 1, 1})
          weight = 64.0 / 2835;
        else if (sizes == std::array<int, 3>{1, 1, 1})
          weight = 27.0 / 1280;
        else if (sizes == std::array<int, 3>{1, 1, 3})
          weight = 14641.0 / 725760;
        else
          continue;
        const Vec3d way{double(x), double(y), double(z)};
        rule.directions[count] = times(way, 1 / length(way));
        rule.weights[count++] = weight;
      }
  return rule;
}

const ExpansionRule& rule() {
  static const ExpansionRule instance = lebedevRule();
  return instance;
}

// The contribution of the value at point i of the ball's surface to the expansion at x, in radii.
double share(std::size_t i, const Vec3d& x) {
  const double along = dot(rule().directions[i], x), square = dot(x, x);
  // r^n P_n by their recurrence.
  double before = 1, now = along, sum = 1 + 3 * along;
  for (int n = 1; n < kExpansionDegree; ++n) {
    const double next = ((2 * n + 1) * along * now - n * square * before) / (n + 1);
    before = now;
    now = next;
    sum += (2 * n + 3) * now;
  }
  return rule().weights[i] * sum;
}

std::unique_ptr<const ExpansionTables> makeTables() {
  auto made = std::make_unique<ExpansionTables>();
  made->rule = rule();
  const double half = 1 / std::sqrt(3.0); // a cube's half side, in radii
  for (std::size_t o = 0; o < 8; ++o)
    for (std::size_t i = 0; i < kExpansionPoints; ++i)
      for (std::size_t j = 0; j < kExpansionStride; ++j) {
        made->octants[o][i][j] = 0;
        if (j >= kExpansionPoints)
          continue;
        const Vec3d centre{(o & 4) != 0 ? half / 2 : -half / 2, (o & 2) != 0 ? half / 2 : -half / 2,
                           (o & 1) != 0 ? half / 2 : -half / 2};
        made->octants[o][i][j] = share(i, plus(centre, times(rule().directions[j], 0.5)));
      }
  for (std::size_t i = 0; i < kExpansionPoints; ++i)
    for (std::size_t v = 0; v < 64; ++v) {
      const auto at = [half](std::size_t k) { return (double(k) - 1.5) / 2 * half; };
      made->voxels[i][v] = share(i, {at(v / 16), at(v / 4 % 4), at(v % 4)});
    }
  return made;
}

TETVDB_MULTIVERSION
void apply56(const double (*columns)[56], const double* in, double* __restrict out) {
  double sums[56] = {};
  for (std::size_t i = 0; i < kExpansionPoints; ++i)
    for (std::size_t j = 0; j < 56; ++j)
      sums[j] += columns[i][j] * in[i];
  for (std::size_t j = 0; j < 56; ++j)
    out[j] = sums[j];
}

TETVDB_MULTIVERSION
void apply64(const double (*columns)[64], const double* in, double* __restrict out) {
  double sums[64] = {};
  for (std::size_t i = 0; i < kExpansionPoints; ++i)
    for (std::size_t j = 0; j < 64; ++j)
      sums[j] += columns[i][j] * in[i];
  for (std::size_t j = 0; j < 64; ++j)
    out[j] = sums[j];
}

} // namespace

const ExpansionTables& expansionTables() {
  static const std::unique_ptr<const ExpansionTables> instance = makeTables();
  return *instance;
}

const std::array<Vec3d, kExpansionPoints>& expansionDirections() {
  return rule().directions;
}

void expandInOctant(const Expansion& cube, std::size_t octant, Expansion& out) {
  static_assert(kExpansionStride == 56);
  apply56(expansionTables().octants[octant], cube.values.data(), out.values.data());
}

void expandAtVoxels(const Expansion& cube, VoxelValues& values) {
  apply64(expansionTables().voxels, cube.values.data(), values.data());
}

ExpansionRange rangeOf(const Expansion& cube, double share) {
  return rangeOf(rule(), cube.values.data(), share);
}

} // namespace tetvdb
