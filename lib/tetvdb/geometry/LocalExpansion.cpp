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

constexpr std::size_t kStride = sizeof(Expansion) / sizeof(double);

struct Rule {
  std::array<Vec3d, kExpansionPoints> directions;
  std::array<double, kExpansionPoints> weights;
};

// V. I. Lebedev, "Quadratures on a sphere", USSR Computational Mathematics and Mathematical Physics
// 16 (1976): the rule of order 11. Points are all permutations and signs of (1, 0, 0), (1, 1, 0),
// (1, 1, 1) and (1, 1, 3).
Rule lebedevRule() {
  Rule rule{};
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

const Rule& rule() {
  static const Rule instance = lebedevRule();
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

// Column i: the contributions of a one at point i to the values at `Rows` positions.
template <std::size_t Rows>
struct Operator {
  alignas(64) double columns[kExpansionPoints][Rows];
};

struct Operators {
  Operator<kStride> octants[8];
  Operator<64> voxels;
};

std::unique_ptr<const Operators> makeOperators() {
  auto made = std::make_unique<Operators>();
  const double half = 1 / std::sqrt(3.0); // a cube's half side, in radii
  for (std::size_t o = 0; o < 8; ++o)
    for (std::size_t i = 0; i < kExpansionPoints; ++i)
      for (std::size_t j = 0; j < kStride; ++j) {
        made->octants[o].columns[i][j] = 0;
        if (j >= kExpansionPoints)
          continue;
        const Vec3d centre{(o & 4) != 0 ? half / 2 : -half / 2, (o & 2) != 0 ? half / 2 : -half / 2,
                           (o & 1) != 0 ? half / 2 : -half / 2};
        made->octants[o].columns[i][j] = share(i, plus(centre, times(rule().directions[j], 0.5)));
      }
  for (std::size_t i = 0; i < kExpansionPoints; ++i)
    for (std::size_t v = 0; v < 64; ++v) {
      const auto at = [half](std::size_t k) { return (double(k) - 1.5) / 2 * half; };
      made->voxels.columns[i][v] = share(i, {at(v / 16), at(v / 4 % 4), at(v % 4)});
    }
  return made;
}

const Operators& operators() {
  static const std::unique_ptr<const Operators> instance = makeOperators();
  return *instance;
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

const std::array<Vec3d, kExpansionPoints>& expansionDirections() {
  return rule().directions;
}

void expandInOctant(const Expansion& cube, std::size_t octant, Expansion& out) {
  static_assert(kStride == 56);
  apply56(operators().octants[octant].columns, cube.values.data(), out.values.data());
}

void expandAtVoxels(const Expansion& cube, VoxelValues& values) {
  apply64(operators().voxels.columns, cube.values.data(), values.data());
}

// The parts of degree 0 and 1 follow exactly. The remainders at the points form the degrees 2 to 5,
// which are at most kRest times their largest value: on the sphere, the sum over the points of w_i
// |sum over n of (2 n + 1) P_n| is below 3.73 everywhere.
constexpr double kRest = 3.75;
ExpansionRange rangeOf(const Expansion& cube, double share) {
  const Rule& r = rule();
  double midpoint = 0;
  Vec3d slope{0, 0, 0};
  for (std::size_t i = 0; i < kExpansionPoints; ++i) {
    const double value = r.weights[i] * cube.values[i];
    midpoint += value;
    for (std::size_t k = 0; k < 3; ++k)
      slope[k] += 3 * value * r.directions[i][k];
  }
  double rest = 0;
  for (std::size_t i = 0; i < kExpansionPoints; ++i)
    rest = std::max(rest, std::abs(cube.values[i] - midpoint - dot(slope, r.directions[i])));
  return {midpoint, share * (length(slope) + share * kRest * rest)};
}

double expansionError(double distance, double area) {
  // The part of degree n of a triangle's solid angle is at most the integral over it of (n + 1) /
  // r^(n + 2); for an infinite plane (n + 1) 2 pi / n distance^n.
  const double q = 1 / distance;
  const double small = area * q * q * (kExpansionDegree + 2);
  const double first = std::min(small, 2 * kPi * (kExpansionDegree + 2) / (kExpansionDegree + 1));
  double power = q;
  for (int n = 1; n <= kExpansionDegree; ++n)
    power *= q;
  // Omitted degrees, and their aliasing by the rule into lower ones.
  return 2 * first * power / (1 - q);
}

} // namespace tetvdb
