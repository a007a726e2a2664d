// SPDX-License-Identifier: Apache-2.0
//
// Local expansions: a function that is harmonic in a ball, known by its values at 50 points of the
// ball's surface. From these its expansion to degree 5 follows by an integration rule over the
// sphere that is exact to degree 11 (Lebedev 1976): at x, with s_i the points' directions and w_i
// their weights,
//
//     f(x) = sum of w_i f(s_i) sum over n <= 5 of (2 n + 1) |x|^n P_n(cos(x, s_i)).
//
// What lies around a cube of voxels is expanded in the ball around the cube.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <array>
#include <cstddef>

namespace tetvdb {

constexpr int kExpansionDegree = 5;
constexpr std::size_t kExpansionPoints = 50;
/// Voxels along the smallest cubes.
constexpr std::size_t kExpandedVoxels = 4;

/// Values at the points, and a few zeros more.
struct Expansion {
  alignas(64) std::array<double, 56> values{};
};

/// Unit vectors from the ball's centre to the points.
const std::array<Vec3d, kExpansionPoints>& expansionDirections();

/// The same function in the ball around one eighth of the cube: the one towards +x where bit 2 of
/// `octant` is set, +y bit 1, +z bit 0.
void expandInOctant(const Expansion& cube, std::size_t octant, Expansion& out);

/// Its values at the centres of the 4^3 voxels that the cube is made of: (x, y, z) at
/// [(x * 4 + y) * 4 + z].
using VoxelValues = std::array<double, kExpandedVoxels * kExpandedVoxels * kExpandedVoxels>;
void expandAtVoxels(const Expansion& cube, VoxelValues& values);

/// The value at the centre, and a bound on how far the expansion gets from it within `share` of the
/// ball's radius.
struct ExpansionRange {
  double midpoint, change;
};
ExpansionRange rangeOf(const Expansion& cube, double share);

/// Bound on what the expansion of a triangle's solid angle is wrong by anywhere in a ball. Lengths
/// are in radii of the ball: `distance` of the triangle from the centre, above 1, `area` is the
/// triangle's. Bounds of several triangles add up.
double expansionError(double distance, double area);

} // namespace tetvdb
