// SPDX-License-Identifier: Apache-2.0
//
// Deformed shapes: points are moved by a vector array.
#pragma once

#include "tetvdb/mesh/TetMesh.h"

#include <string>

namespace tetvdb {

/// The array that moves the points, and its factor.
struct Warp {
  std::string array; ///< of vectors at the points; empty: no warp
  double factor = 1;
};

/// Moves every point by factor times its vector. "u_x", "u_y", "u_z" are used as "u", as in
/// resolveFields(). Throws Error(Usage) if the points have no such array, or one without three
/// components; Error(Invalid) for a vector of a used point that is not finite, or an array of the
/// wrong length. Parallel, linear.
void warpPoints(TetMesh& mesh, const Warp& warp);

} // namespace tetvdb
