// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/SoupChain.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tetvdb {

Boundary soupFaces(const TriangleMesh& mesh, const SnappedMesh& snapped) {
  Boundary chain;
  chain.faces.resize(mesh.triangleCount());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chain.faces.size(), 16384),
                    [&](const auto& range) {
                      for (std::size_t t = range.begin(); t != range.end(); ++t)
                        chain.faces[t] = {mesh.triangles[3 * t], mesh.triangles[3 * t + 1],
                                          mesh.triangles[3 * t + 2], 1};
                    });
  const double longest =
      std::max({snapped.boxMax.x - snapped.boxMin.x, snapped.boxMax.y - snapped.boxMin.y,
                snapped.boxMax.z - snapped.boxMin.z});
  if (longest <= kMaxTetExtent)
    return chain;
  for (const BoundaryFace& f : chain.faces) {
    const LatticePoint &a = snapped.points[f.a], &b = snapped.points[f.b], &c = snapped.points[f.c];
    const auto extent = [&](double LatticePoint::*k) {
      return std::max({a.*k, b.*k, c.*k}) - std::min({a.*k, b.*k, c.*k});
    };
    if (std::max({extent(&LatticePoint::x), extent(&LatticePoint::y), extent(&LatticePoint::z)}) >
        kMaxTetExtent)
      throw Error(Status::Limit, "", "a triangle is longer than 2^20 voxels",
                  "use larger voxels, or subdivide the mesh");
  }
  return chain;
}

std::vector<BoundaryEdge> boundaryEdges(const std::vector<IndexedBoundaryEdge>& edges,
                                        const SnappedMesh& snapped) {
  std::vector<BoundaryEdge> placed;
  placed.reserve(edges.size());
  for (const IndexedBoundaryEdge& e : edges)
    placed.push_back({snapped.points[e.a], snapped.points[e.b], e.weight});
  return placed;
}

BoundaryWinding boundaryWinding(const std::vector<IndexedBoundaryEdge>& edges,
                                const SnappedMesh& snapped) {
  return BoundaryWinding(boundaryEdges(edges, snapped));
}

} // namespace tetvdb
