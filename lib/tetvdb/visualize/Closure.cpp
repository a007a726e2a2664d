// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/Closure.h"

#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/WeldPoints.h"

namespace tetvdb {

Closure closureOf(const TriangleMesh& mesh, Progress& progress) {
  const std::vector<std::uint32_t> corners = weldedCorners(mesh, progress);
  const EdgeTable edges(corners, mesh.points.size());
  progress.check();
  Closure closure = edges.edgeCount() > 0 ? Closure::Winding : Closure::Open;
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    const int balance = edges.imbalance(edge);
    if (balance % 2 != 0)
      return Closure::Open;
    if (balance != 0)
      closure = Closure::Parity;
  }
  return closure;
}

} // namespace tetvdb
