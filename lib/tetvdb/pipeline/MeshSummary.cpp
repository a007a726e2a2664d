// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/MeshSummary.h"

#include <utility>

namespace tetvdb {

MeshSummary summarize(Tetrahedralization&& made, TetMesh& mesh) {
  mesh = std::exchange(made.mesh, {});
  mesh.cellOfTet.clear();
  mesh.cellCount = mesh.tetCount();
  MeshSummary summary;
  summary.statistics = measure(mesh);
  summary.tets = mesh.tetCount();
  summary.vertices = mesh.points.size();
  for (const std::int32_t region : mesh.regions)
    ++summary.tetsOfRegion[region];
  summary.made = std::move(made);
  return summary;
}

} // namespace tetvdb
