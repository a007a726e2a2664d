// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TetStatistics.h"
#include "tetvdb/tetrahedralize/Tetrahedralize.h"

#include <cstddef>
#include <cstdint>
#include <map>

namespace tetvdb {

/// What the envelope mesher made, without the tets.
struct MeshSummary {
  Tetrahedralization made; ///< its mesh is empty
  TetStatistics statistics;
  std::size_t tets = 0, vertices = 0;
  std::map<std::int32_t, std::size_t> tetsOfRegion;

  /// Volume of the tets' own boxes over the tets' volume: how many voxel centres are looked at for
  /// one that is inside.
  double boxOverVolume() const {
    return statistics.volume > 0 ? statistics.boxVolume / statistics.volume : 0;
  }
};

/// Takes `made` apart: the mesh, every tet its own cell, and the rest.
MeshSummary summarize(Tetrahedralization&& made, TetMesh& mesh);

} // namespace tetvdb
