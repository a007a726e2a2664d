// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/Closure.h"

#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/WeldPoints.h"

namespace tetvdb {

Closure closureOf(const TriangleMesh& mesh, Progress& progress) {
  const std::vector<std::uint32_t> becomes = weldPoints(mesh.points, 0, progress);
  std::vector<std::uint32_t> corners(mesh.triangles.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = becomes[mesh.triangles[i]];
  const EdgeTable edges(corners, mesh.points.size());
  progress.check();
  Closure closure = edges.edgeCount() > 0 ? Closure::Winding : Closure::Open;
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    std::int64_t balance = 0;
    for (const std::uint32_t side : edges.sides(edge))
      balance += edges.ascends(side) ? 1 : -1;
    if (balance % 2 != 0)
      return Closure::Open;
    if (balance != 0)
      closure = Closure::Parity;
  }
  return closure;
}

} // namespace tetvdb
