// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/WindingField.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"

namespace tetvdb {

WindingField::WindingField(const TriangleMesh& mesh, const EdgeTable& edges)
    : ownScene_(std::in_place, mesh), scene_(&*ownScene_) {
  addBoundary(mesh, edges);
}

WindingField::WindingField(const TriangleMesh& mesh, const EdgeTable& edges,
                           const TriangleScene& scene)
    : scene_(&scene) {
  addBoundary(mesh, edges);
}

void WindingField::addBoundary(const TriangleMesh& mesh, const EdgeTable& edges) {
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
    if (const int weight = edges.imbalance(edge); weight != 0)
      boundary_.push_back(
          {mesh.points[edges.lowPoint(edge)], mesh.points[edges.highPoint(edge)], double(weight)});
  Box box;
  for (const std::uint32_t corner : mesh.triangles)
    box.add(mesh.points[corner]);
  if (!mesh.triangles.empty())
    reach_ = 2 * length(minus(box.high, box.low));
}

double WindingField::at(const Vec3d& p) const {
  std::vector<TriangleScene::Hit> hits;
  scene_->crossings(p, times(kCurtainUp, -1), reach_, hits);
  double winding = 0;
  for (const TriangleScene::Hit& hit : hits)
    winding += hit.leaving ? 1 : -1;
  for (const CurtainEdge& edge : boundary_)
    winding += curtainWinding(edge, p);
  return winding;
}

} // namespace tetvdb
