// SPDX-License-Identifier: Apache-2.0
//
// The surfaces of the inputs in a tet mesh: for each a chain of triangles.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"
#include "tetvdb/tetrahedralize/inside/ChainWinding.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Digit `input` of a sum of inputs' digits (see Chain), `bits` each.
std::int64_t chainDigit(std::int64_t sum, std::size_t input, int bits);

/// The tracked faces of one input and those faces of the soup that are missing in the mesh.
struct InputChain {
  struct Face {
    std::array<std::uint32_t, 3> corners; ///< in InputChains::points
    std::int32_t weight;                  ///< how often it counts; not 0
  };
  std::vector<Face> faces;
  std::size_t missingBegin = 0; ///< faces from here on are missing ones
  /// An edge that faces run along `weight` times more often from a to b than from b to a.
  struct Edge {
    std::uint32_t a, b;
    std::int32_t weight; ///< > 0
  };
  std::vector<Edge> boundary; ///< none: the chain is closed

  /// Closed, and all of it in the mesh: the winding number is the same all over a tet.
  bool isFlooded() const { return boundary.empty() && missingBegin == faces.size(); }
};

struct InputChains {
  /// The complex's, then the positions that only missing faces have: corners are matched by
  /// position.
  std::vector<Vec3d> points;
  std::vector<InputChain> inputs;
};

/// A missing face closes the chain only where its edges are edges of the mesh: where a straight
/// edge of it is a path of several in the mesh a slit stays open, within tolerance. About 10 ns a
/// tet and 0.3 us a face.
InputChains inputChains(const TetComplex& complex, std::size_t inputCount, const LatticeSoup& soup,
                        const std::vector<std::uint32_t>& missing, Progress& progress);

/// What ChainWinding's coordinates are multiplied by: a tet's centre is a fourth of the sum of its
/// corners.
constexpr double kCentreLattice = 4;

/// The winding number of an input's chain, by points in units of kCentreLattice.
ChainWinding chainWinding(const InputChains& chains, std::size_t input);

/// The centre of a tet, in the same units: the sum of its corners.
inline LatticePoint tetCentre(const TetComplex& complex, const TetComplex::Tet& tet) {
  LatticePoint sum{0, 0, 0};
  for (const std::uint32_t corner : tet.corners) {
    const Vec3d& at = complex.at(corner);
    sum = {sum.x + at[0], sum.y + at[1], sum.z + at[2]};
  }
  return sum;
}

} // namespace tetvdb
