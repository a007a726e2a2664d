// SPDX-License-Identifier: Apache-2.0
//
// The methods that convert triangles into a solid.
#pragma once

#include <cstdint>
#include <string>

namespace tetvdb {

enum class Mesher : std::uint8_t {
  Auto,     ///< chosen by chooseMesher()
  Envelope, ///< tets within epsilon (tetrahedralize/Tetrahedralize.h)
  Winding   ///< directly to voxels, by SolidOptions::inside (voxelize/VoxelizeTriangles.h)
};

/// "auto", "envelope" or "winding".
std::string nameOf(Mesher mesher);

struct MesherChoice {
  Mesher method = Mesher::Winding; ///< not Auto
  std::string why;                 ///< one clause, without a full stop
  double epsilon = 0;              ///< of the envelope, world units; 0 for other methods
};

} // namespace tetvdb
