// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The triangles of all inputs on the working lattice, as they pass through the mesher's stages.
/// No two points are equal, every point is used, no face has a repeated point, and no input has
/// two faces over the same three points. Faces may be collinear, cross each other and end anywhere.
struct LatticeSoup {
  std::vector<Vec3d> points; ///< lattice points (WorkingLattice.h)
  double grain = 1;          ///< that their coordinates are multiples of: a power of two
  std::vector<std::array<std::uint32_t, 3>> faces;
  std::vector<std::uint16_t> inputs; ///< of every face; empty: all of input 0
};

/// Two points of an edge as one number, the same in both directions.
inline std::uint64_t edgeKey(std::uint32_t a, std::uint32_t b) {
  return a < b ? std::uint64_t(a) << 32 | b : std::uint64_t(b) << 32 | a;
}

/// The boundary edges: those of exactly one face, in the order of faces.
std::vector<std::array<std::uint32_t, 2>> openEdges(const LatticeSoup& soup);

/// The inputs' triangles snapped to the lattice, to multiples of `grain` on it; points
/// that become equal are merged and faces with a repeated point dropped. Of an input's faces over
/// the same three points pairs of opposite orientation are dropped, and one of the others stays.
/// Faces keep the inputs' order.
///   Faces that should be coplanar are off by about a grain, which has to be well below the
/// tolerance of insertion.
LatticeSoup latticeSoup(const std::vector<TriangleMesh>& inputs, const WorkingLattice& lattice,
                        double grain, Progress& progress);

/// Restores LatticeSoup's conditions after points have moved, as latticeSoup() does.
void tidySoup(LatticeSoup& soup, Progress& progress);

} // namespace tetvdb
