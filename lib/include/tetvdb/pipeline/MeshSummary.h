// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TetStatistics.h"
#include "tetvdb/tetrahedralize/Tetrahedralize.h"

#include <cstddef>
#include <cstdint>
#include <map>

namespace tetvdb {

/// The result of the envelope mesher, without the tets.
struct MeshSummary {
  Tetrahedralization made; ///< its mesh is empty
  TetStatistics statistics;
  std::size_t tets = 0, vertices = 0;
  std::map<std::int32_t, std::size_t> tetsOfRegion;

  /// Volume of the tets' boxes over the volume of the tets: the number of voxel centres tested per
  /// voxel centre that is inside.
  double boxOverVolume() const {
    return statistics.volume > 0 ? statistics.boxVolume / statistics.volume : 0;
  }
};

/// Splits `made` into the mesh, with every tet as a cell of its own, and the rest.
MeshSummary summarize(Tetrahedralization&& made, TetMesh& mesh);

} // namespace tetvdb
