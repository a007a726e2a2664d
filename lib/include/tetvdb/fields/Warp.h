// SPDX-License-Identifier: Apache-2.0
//
// Deformed shapes: points moved by a vector array.
#pragma once

#include "tetvdb/mesh/TetMesh.h"

#include <string>

namespace tetvdb {

/// Which array moves the points, and how far.
struct Warp {
  std::string array; ///< of vectors at the points; empty: no warp
  double factor = 1;
};

/// Moves every point by factor times its vector. "u_x", "u_y", "u_z" serve as "u", as in
/// resolveFields(). Throws Error(Usage) where the points have no such array, or one that is not of
/// three components; Error(Invalid) for a vector of a point in use that is not finite, or an array
/// of the wrong length. Parallel, linear.
void warpPoints(TetMesh& mesh, const Warp& warp);

} // namespace tetvdb
