// SPDX-License-Identifier: Apache-2.0
//
// What must hold of tets made from triangles, looked at without the code that made them.
//
//   TetMeshCheck check = checkTetMesh(made, cleaned, epsilon, {});
//   EXPECT_EQ(check.faults(), "");
#pragma once

#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace tetvdb {

/// How closely to look. Points are the same for the same numbers.
struct TetCheckSamples {
  std::size_t surface = 100000; ///< of the tets' surface, and of the input
  std::size_t winding = 2000;   ///< each is summed over all input triangles
  std::size_t overlap = 20000;
  std::uint64_t seed = 1;
};

/// Lengths in world units. Tets of region -1 are outside: they count for validity alone. The tets'
/// surface is the faces between inside and outside.
struct TetMeshCheck {
  double epsilon = 0;
  std::size_t tets = 0, insideTets = 0;

  // Validity.
  std::size_t notPositive = 0;       ///< volume not above 0, exactly
  std::size_t wrongFaces = 0;        ///< of more than two tets, or of two on the same side
  std::size_t overlappingPoints = 0; ///< samples in more than one tet
  std::size_t surfaceFaces = 0;
  std::size_t unevenEdges = 0; ///< of an odd number of surface faces
  double volume = 0;           ///< sum over the inside tets
  double enclosedVolume = 0;   ///< by the divergence theorem over the surface

  // Both distances.
  bool closedInput = false; ///< every edge of the input is passed as often each way
  double outToIn = 0;       ///< largest from the tets' surface to the input
  double inToOut = 0;       ///< largest from the input to the tets' surface
  /// Input samples farther than epsilon from the tets' surface; how many of these were looked at;
  /// those of them where the winding number half an epsilon to either side is on either side of
  /// 0.5, so that there should be a surface.
  std::size_t farPoints = 0, judgedFarPoints = 0, lostPoints = 0;

  // Inside and outside, at points farther than two epsilon from the input.
  std::size_t windingPoints = 0; ///< judged; not those within 0.1 of a winding number of 0.5
  std::size_t wrongPoints = 0;   ///< inside by the tets or by the winding number, not by both

  // Shape, of the inside tets.
  double worstEnergy = 0, meanEnergy = 0;       ///< AMIPS, 3 for the regular tet
  double smallestAngle = 180, largestAngle = 0; ///< between faces, degrees

  /// What should not be, by name, separated by spaces; empty for a valid mesh. Lost points are none
  /// (walls thinner than two epsilon may go), nor is the surface's distance where the input is
  /// open (what closes a hole is far from it).
  std::string faults() const;
  /// One line.
  std::string json() const;
};

/// `input` is cleaned (cleanTriangles()), so that its winding number means something. Parallel; the
/// same answer for any number of threads. A few seconds for 200 000 tets and 100 000 triangles.
TetMeshCheck checkTetMesh(const TetMesh& mesh, const TriangleMesh& input, double epsilon,
                          const TetCheckSamples& samples);

} // namespace tetvdb
