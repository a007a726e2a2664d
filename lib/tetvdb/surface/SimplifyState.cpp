// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/SimplifyState.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/EdgeTable.h"

#include <algorithm>

namespace tetvdb {
namespace {

constexpr double kLongSide = 3;          ///< in mean edge lengths
constexpr double kUnitOfDiagonal = 1e-3; ///< without a tolerance

std::array<float, 3> unitOf(const Vec3d& v) {
  const double l = length(v), factor = l > 0 ? 1 / l : 0;
  return {static_cast<float>(v[0] * factor), static_cast<float>(v[1] * factor),
          static_cast<float>(v[2] * factor)};
}

} // namespace

SimplifyState::SimplifyState(const TriangleMesh& before, const SimplifyOptions& options)
    : mesh(before), outward(options.outward), isGone(before.triangleCount(), 0),
      points(before.points), normals(before.points.size()), quadrics(before.points.size()),
      isTested(before.points.size(), 0), firstGone(before.triangleCount(), kNone),
      nextGone(before.points.size(), kNone) {
  const EdgeTable edges(mesh);
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
    if (!edges.isManifold(edge))
      throw Error(Status::Invalid, "", "the surface is not a closed manifold");
  if (options.featureDegrees < 180)
    features = featureEdges(mesh, options.featureDegrees);
  Box box;
  for (const Vec3d& p : points)
    box.add(p);
  midpoint_ = times(plus(box.low, box.high), 0.5);
  unit_ = options.tolerance > 0 ? options.tolerance
                                : kUnitOfDiagonal * length(minus(box.high, box.low));
  for (Vec3d& p : points)
    p = times(minus(p, midpoint_), 1 / unit_);
  std::vector<Vec3d> sums(points.size(), Vec3d{0, 0, 0}), ofFaces(mesh.triangleCount());
  double lengths = 0;
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face) {
    const std::uint32_t* v = &mesh.triangles[3 * face];
    const Vec3d n = cross(minus(points[v[1]], points[v[0]]), minus(points[v[2]], points[v[0]]));
    const double twice = length(n);
    const Vec3d normal = times(n, twice > 0 ? 1 / twice : 0);
    ofFaces[face] = normal;
    for (std::size_t k = 0; k < 3; ++k) {
      quadrics[v[k]].add(normal, -dot(normal, points[v[0]]), twice / 6);
      sums[v[k]] = plus(sums[v[k]], n);
      lengths += length(minus(points[v[(k + 1) % 3]], points[v[k]]));
    }
  }
  meanEdge = lengths / static_cast<double>(mesh.triangles.size());
  longSide = kLongSide * kLongSide * meanEdge * meanEdge;
  for (std::size_t v = 0; v < sums.size(); ++v)
    normals[v] = unitOf(sums[v]);
  if (!(options.tolerance > 0))
    return;
  original = std::make_unique<TriangleScene>(before);
  if (outward)
    return;
  points.reserve(points.size() + edges.edgeCount());
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    const EdgeTable::Sides sides = edges.sides(edge);
    const std::uint32_t face = EdgeTable::faceOf(sides[0]);
    nextGone.push_back(firstGone[face]);
    firstGone[face] = static_cast<std::uint32_t>(points.size());
    points.push_back(times(plus(points[edges.lowPoint(edge)], points[edges.highPoint(edge)]), 0.5));
    normals.push_back(unitOf(plus(ofFaces[face], ofFaces[EdgeTable::faceOf(sides[1])])));
  }
}

bool SimplifyState::isNear(const Vec3d& p) const {
  return original->isWithin(plus(midpoint_, times(p, unit_)), kHeldTolerance * unit_);
}

std::size_t SimplifyState::liveFaces() const {
  return static_cast<std::size_t>(std::count(isGone.begin(), isGone.end(), char(0)));
}

} // namespace tetvdb
