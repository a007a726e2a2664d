// SPDX-License-Identifier: Apache-2.0
//
// The beams and balls of a 3MF object as triangles. Format: 3MF Consortium, "Beam Lattice
// Extension".
#pragma once

#include "tetvdb/core/Vec3.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

/// How a beam ends: by a plane through the end point, by half a ball, or by a whole one.
enum class BeamCap : std::uint8_t { Butt, Hemisphere, Sphere };

/// The frustum of a cone between two vertices of the object's mesh.
struct Beam {
  std::array<std::uint32_t, 2> ends{};
  std::array<double, 2> radius{}; ///< in the model's unit; NAN if it cannot be read
  std::array<BeamCap, 2> cap{};
};

struct LatticeBall {
  std::uint32_t vertex = 0;
  double radius = 0;
};

struct BeamLattice {
  std::vector<Beam> beams;
  std::vector<LatticeBall> balls;
  bool clipped = false;       ///< by another object, inside or outside of it
  std::string representation; ///< an object that is the lattice as a mesh; "" if there is none

  bool isEmpty() const { return beams.empty() && balls.empty(); }
};

/// Closed surfaces that overlap: the lattice is where their winding number is positive.
struct LatticeFaces {
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> triangles;
  std::size_t invalid = 0; ///< beams and balls without a radius above 0, or without a vertex
};

/// Cross-sections are regular 16-gons of the area of their circle, so that the surface is between
/// 0.7 % of the radius inside and 1.3 % outside. Half balls have 6 rings. Balls are icosahedra in
/// 320 faces, of the ball's volume: one for all beams that end at a vertex with BeamCap::Sphere, of
/// the largest radius. 34 points and 64 triangles a beam without half balls, 162 and 320 a ball.
/// Throws Error(Limit) with `path` where memory does not suffice.
LatticeFaces facesOfLattice(const BeamLattice& lattice, const std::vector<Vec3d>& vertices,
                            const std::string& path);

} // namespace tetvdb
