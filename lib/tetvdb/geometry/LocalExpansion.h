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

#include "tetvdb/core/Vec3.h"

#include <array>
#include <cstddef>

namespace tetvdb {

constexpr int kExpansionDegree = 5;
constexpr std::size_t kExpansionPoints = 50;
/// Voxels along the smallest cubes.
constexpr std::size_t kExpandedVoxels = 4;

/// Values at the points, with padding of zeros.
struct Expansion {
  alignas(64) std::array<double, 56> values{};
};

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

/// Bound on the error of the expansion of a triangle's solid angle anywhere in a ball. Lengths are
/// in radii of the ball: `distance` of the triangle from the centre, above 1; `area` is the
/// triangle's. Bounds of several triangles are added.
double expansionError(double distance, double area);

} // namespace tetvdb
