// SPDX-License-Identifier: Apache-2.0
//
// Local expansions: a function that is harmonic in a ball, given by its values at 50 points of
// the ball's surface. Its expansion to degree 5 follows by an integration rule over the sphere
// that is exact to degree 11 (Lebedev 1976): at x, with s_i the points' directions and w_i their
// weights,
//
//     f(x) = sum of w_i f(s_i) sum over n <= 5 of (2 n + 1) |x|^n P_n(cos(x, s_i)).
//
// The surroundings of a cube of voxels are expanded in the ball around the cube.
#pragma once

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/HostDevice.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace tetvdb {

constexpr int kExpansionDegree = 5;
constexpr std::size_t kExpansionPoints = 50;
/// Voxels along the smallest cubes.
constexpr std::size_t kExpandedVoxels = 4;

/// Values at the points, with padding of zeros.
constexpr std::size_t kExpansionStride = 56;
struct Expansion {
  alignas(64) std::array<double, kExpansionStride> values{};
};

/// Unit vectors from the ball's centre to the points, and their weights.
struct ExpansionRule {
  std::array<Vec3d, kExpansionPoints> directions;
  std::array<double, kExpansionPoints> weights;
};

/// Matrices, column by column: what a one at point i contributes to the values at the points of an
/// octant's ball, and at the voxels of the smallest cubes.
struct ExpansionTables {
  alignas(64) double octants[8][kExpansionPoints][kExpansionStride];
  alignas(64) double voxels[kExpansionPoints][64];
  ExpansionRule rule;
};
const ExpansionTables& expansionTables();

/// Unit vectors from the ball's centre to the points.
const std::array<Vec3d, kExpansionPoints>& expansionDirections();

/// The same function in the ball around one eighth of the cube: the one toward +x if bit 2 of
/// `octant` is set, +y bit 1, +z bit 0.
void expandInOctant(const Expansion& cube, std::size_t octant, Expansion& out);

/// Its values at the centres of the cube's 4^3 voxels: (x, y, z) at [(x * 4 + y) * 4 +
/// z].
using VoxelValues = std::array<double, kExpandedVoxels * kExpandedVoxels * kExpandedVoxels>;
void expandAtVoxels(const Expansion& cube, VoxelValues& values);

/// The value at the centre, and a bound on the difference from it within `share` of the ball's
/// radius.
struct ExpansionRange {
  double midpoint, change;
};
ExpansionRange rangeOf(const Expansion& cube, double share);

// The remainders at the points form the degrees 2 to 5, which are at most this times their largest
// value: on the sphere, the sum over the points of w_i |sum over n of (2 n + 1) P_n| is below 3.73
// everywhere.
constexpr double kExpansionRest = 3.75;

/// Of values at the points. The parts of degree 0 and 1 follow exactly.
TETVDB_HD inline ExpansionRange rangeOf(const ExpansionRule& r, const double* values,
                                        double share) {
  double midpoint = 0;
  Vec3d slope{0, 0, 0};
  for (std::size_t i = 0; i < kExpansionPoints; ++i) {
    const double value = r.weights[i] * values[i];
    midpoint += value;
    for (std::size_t k = 0; k < 3; ++k)
      slope[k] += 3 * value * r.directions[i][k];
  }
  double rest = 0;
  for (std::size_t i = 0; i < kExpansionPoints; ++i)
    rest = std::max(rest, std::abs(values[i] - midpoint - dot(slope, r.directions[i])));
  return {midpoint, share * (length(slope) + share * kExpansionRest * rest)};
}

/// Bound on the error of the expansion of a triangle's solid angle anywhere in a ball. Lengths are
/// in radii of the ball: `distance` of the triangle from the centre, above 1; `area` is the
/// triangle's. Bounds of several triangles are added.
TETVDB_HD inline double expansionError(double distance, double area) {
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
