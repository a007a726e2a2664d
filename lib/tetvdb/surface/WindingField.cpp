// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/WindingField.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/surface/WindingCurtain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

// The diagonal of the box, and the largest coordinate, in units of the lattice.
constexpr double kDiagonal = 0x1p36, kMaxCoordinate = 0x1p52;

// Of length 1, perpendicular to one another; the third is kCurtainUp.
const std::array<Vec3d, 3> kAxes = [] {
  Vec3d first = cross({1, 0, 0}, kCurtainUp);
  first = times(first, 1 / length(first));
  return std::array<Vec3d, 3>{first, cross(kCurtainUp, first), kCurtainUp};
}();

} // namespace

WindingField::TurnedLattice::TurnedLattice(const TriangleMesh& mesh) {
  const Box box = boxOf(mesh.points, mesh.triangles);
  if (mesh.triangles.empty())
    return;
  centre = times(plus(box.low, box.high), 0.5);
  diagonal = length(minus(box.high, box.low));
  if (diagonal > 0)
    unitsPerLength = kDiagonal / diagonal;
}

LatticePoint WindingField::TurnedLattice::of(const Vec3d& p) const {
  const Vec3d r = times(minus(p, centre), unitsPerLength);
  return {std::nearbyint(dot(kAxes[0], r)), std::nearbyint(dot(kAxes[1], r)),
          std::nearbyint(dot(kAxes[2], r))};
}

WindingField::WindingField(const TriangleMesh& mesh, const EdgeTable& edges)
    : ownScene_(std::in_place, mesh), scene_(&*ownScene_), lattice_(mesh) {
  addBoundary(mesh, edges);
}

WindingField::WindingField(const TriangleMesh& mesh, const EdgeTable& edges,
                           const TriangleScene& scene)
    : scene_(&scene), lattice_(mesh) {
  addBoundary(mesh, edges);
}

void WindingField::addBoundary(const TriangleMesh& mesh, const EdgeTable& edges) {
  std::vector<BoundaryEdge> boundary;
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
    if (const int weight = edges.imbalance(edge); weight != 0)
      boundary.push_back({lattice_.of(mesh.points[edges.lowPoint(edge)]),
                          lattice_.of(mesh.points[edges.highPoint(edge)]), weight});
  if (boundary.size() > kManyBoundaryEdges)
    many_.emplace(std::move(boundary));
  else
    for (const BoundaryEdge& edge : boundary)
      few_.push(edge.a, edge.b, edge.weight);
}

double WindingField::at(const Vec3d& p) const {
  const LatticePoint onLattice = lattice_.of(p);
  if (std::max({std::abs(onLattice.x), std::abs(onLattice.y), std::abs(onLattice.z)}) >
      kMaxCoordinate)
    return 0; // more than 50,000 diagonals away
  // From above the box, so that the distance does not count.
  const double above = dot(minus(p, lattice_.centre), kCurtainUp) - lattice_.diagonal;
  std::vector<TriangleScene::Hit> hits;
  scene_->crossings(above > 0 ? minus(p, times(kCurtainUp, above)) : p, times(kCurtainUp, -1),
                    2 * lattice_.diagonal, hits);
  double winding = 0;
  for (const TriangleScene::Hit& hit : hits)
    winding += hit.leaving ? 1 : -1;
  return winding + (many_ ? many_->at(onLattice)
                          : sumAngles(few_.view(), 0, few_.size(), onLattice) / (4 * kPi));
}

} // namespace tetvdb
