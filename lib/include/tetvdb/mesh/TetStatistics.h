// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/TetMesh.h"

#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// Measures of a mesh as it is, before any snapping; in world units.
struct TetStatistics {
  Vec3d boxMin{0, 0, 0}; ///< over the points that tets use
  Vec3d boxMax{0, 0, 0};
  double volume = 0;          ///< sum of the tets' volumes, each taken positive
  double boxVolume = 0;       ///< sum of the volumes of the tets' own boxes
  std::uint64_t inverted = 0; ///< tets of negative volume (VTK's order of nodes is positive)
  std::uint64_t flat = 0;     ///< tets whose volume is zero, as far as doubles can tell
};

/// Parallel, the same bits for any number of threads; linear in the number of tets. All zero for a
/// mesh without tets.
TetStatistics measure(const TetMesh& mesh);

} // namespace tetvdb
