// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/SimplifyState.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CubeRegions.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/FacesOfPoints.h"
#include "tetvdb/surface/FloatPositions.h"

#include <algorithm>

namespace tetvdb {
namespace {

constexpr double kLongSide = 3;          ///< in mean edge lengths
constexpr double kUnitOfDiagonal = 1e-3; ///< without a tolerance

Vec3d unit(const Vec3d& v) {
  const double size = length(v);
  return times(v, size > 0 ? 1 / size : 0);
}

} // namespace

SimplifyState::SimplifyState(const TriangleMesh& before, const SimplifyOptions& options)
    : mesh(before), outward(options.outward), isGone(before.triangleCount(), 0),
      points(before.points), normals(before.points.size()), quadrics(before.points.size()),
      isTested(before.points.size(), 0), firstGone(before.triangleCount(), kNone),
      nextGone(before.points.size(), kNone) {
  const EdgeTable edges(mesh);
  if (countWhere(edges.edgeCount(), [&](std::size_t edge) {
        return !edges.isManifold(static_cast<std::uint32_t>(edge));
      }) > 0)
    throw Error(Status::Invalid, "", "the surface is not a closed manifold");
  if (options.featureDegrees < 180)
    features = featureEdges(mesh, options.featureDegrees);
  Box box;
  for (const Vec3d& p : points)
    box.add(p);
  midpoint_ = times(plus(box.low, box.high), 0.5);
  unit_ = options.tolerance > 0 ? options.tolerance
                                : kUnitOfDiagonal * length(minus(box.high, box.low));
  forEachIndex(points.size(),
               [&](std::size_t v) { points[v] = times(minus(points[v], midpoint_), 1 / unit_); });
  const auto cornerOf = [&](std::size_t face, std::size_t k) -> const Vec3d& {
    return points[mesh.triangles[3 * face + k]];
  };
  std::vector<Vec3d> ofFaces(mesh.triangleCount()); // of twice the area's length
  forEachIndex(ofFaces.size(), [&](std::size_t face) {
    ofFaces[face] = cross(minus(cornerOf(face, 1), cornerOf(face, 0)),
                          minus(cornerOf(face, 2), cornerOf(face, 0)));
  });
  const FacesOfPoints facesOf(mesh);
  forEachIndex(normals.size(), [&](std::size_t v) {
    Vec3d sum{0, 0, 0};
    for (const std::uint32_t face : facesOf(v)) {
      const Vec3d normal = unit(ofFaces[face]);
      quadrics[v].add(normal, -dot(normal, cornerOf(face, 0)), length(ofFaces[face]) / 6);
      sum = plus(sum, ofFaces[face]);
    }
    normals[v] = asFloats(unit(sum));
  });
  meanEdge = tetvdb::meanEdge(points, mesh.triangles);
  longSide = kLongSide * kLongSide * meanEdge * meanEdge;
  if (!(options.tolerance > 0))
    return;
  original = std::make_unique<TriangleScene>(before);
  if (outward)
    return;
  const std::size_t vertices = points.size(), all = vertices + edges.edgeCount();
  points.resize(all);
  normals.resize(all);
  nextGone.resize(all);
  forEachIndex(edges.edgeCount(), [&](std::size_t i) {
    const auto edge = static_cast<std::uint32_t>(i);
    const EdgeTable::Sides sides = edges.sides(edge);
    points[vertices + i] =
        times(plus(points[edges.lowPoint(edge)], points[edges.highPoint(edge)]), 0.5);
    normals[vertices + i] = asFloats(unit(plus(unit(ofFaces[EdgeTable::faceOf(sides[0])]),
                                               unit(ofFaces[EdgeTable::faceOf(sides[1])]))));
  });
  forEachIndex(firstGone.size(), [&](std::size_t face) { // the first of two faces has the midpoint
    std::array<std::uint32_t, 3> own{kNone, kNone, kNone};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto side = static_cast<std::uint32_t>(3 * face + k);
      const std::uint32_t edge = edges.edgeOf(side);
      if (edge != kNone && edges.sides(edge)[0] == side)
        own[k] = edge;
    }
    std::sort(own.begin(), own.end());
    for (std::size_t i = 0; i < 3 && own[i] != kNone; ++i) {
      const auto point = static_cast<std::uint32_t>(vertices + own[i]);
      nextGone[point] = firstGone[face];
      firstGone[face] = point;
    }
  });
}

bool SimplifyState::isNear(const Vec3d& p) const {
  return original->isWithin(plus(midpoint_, times(p, unit_)), kHeldTolerance * unit_);
}

std::size_t SimplifyState::liveFaces() const {
  return static_cast<std::size_t>(std::count(isGone.begin(), isGone.end(), char(0)));
}

} // namespace tetvdb
