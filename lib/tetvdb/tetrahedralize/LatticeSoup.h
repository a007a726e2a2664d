// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/tetrahedralize/WorkingLattice.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The triangles of all inputs on the working lattice, as the mesher's stages hand them on.
/// No two points are equal, every point is used, no face has a repeated point, and no input has
/// two faces over the same three points. Faces may be collinear, cross each other and end anywhere.
struct LatticeSoup {
  std::vector<Vec3d> points; ///< lattice points (WorkingLattice.h)
  std::vector<std::array<std::uint32_t, 3>> faces;
  std::vector<std::uint16_t> inputs; ///< of every face; empty: all of input 0
};

/// The inputs' triangles snapped to the lattice; what becomes equal or loses its area to a repeated
/// point is dropped, and of an input's faces over the same three points pairs that look opposite
/// ways go, one of the others stays. Faces keep the inputs' order.
LatticeSoup latticeSoup(const std::vector<TriangleMesh>& inputs, const WorkingLattice& lattice,
                        Progress& progress);

/// Makes a soup keep its promises after points have moved: as latticeSoup() does.
void tidySoup(LatticeSoup& soup, Progress& progress);

} // namespace tetvdb
