// SPDX-License-Identifier: Apache-2.0
//
// Inside or outside of a solid, and the signed distance to its surface, at any points.
//
//   tetvdb::SolidQuery solid(std::move(mesh), progress);   // cleaned triangles
//   std::vector<double> distance(n);
//   solid.at(points, n, nullptr, distance.data(), progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace tetvdb {

/// A point is inside where the winding number of the faces is above 0.5, the rule of voxelize().
/// Corners and points are rounded to a lattice of 2^37 to 2^38 units along the box's longest side.
/// Of a mesh that closes every answer is exact on that lattice, and a point on a face belongs to
/// one of its sides by the rule of geometry/Ownership.h. Of an open mesh the sums over its boundary
/// edges are rounded: points whose winding number is within 1e-3 of 0.5 may come out on either
/// side. Points farther from the box than its longest side are outside.
///
/// Immutable once made; at() is thread-safe.
class SolidQuery {
public:
  /// `mesh` is taken as it is: clean it first (surface/CleanTriangles.h). Throws Error(Invalid) as
  /// checkMesh() does, and for a mesh without faces. About 1 us a face.
  SolidQuery(TriangleMesh mesh, Progress& progress);
  ~SolidQuery();
  SolidQuery(const SolidQuery&) = delete;
  SolidQuery& operator=(const SolidQuery&) = delete;

  /// Boundary edges of the mesh: 0 where it closes.
  std::size_t openEdges() const;
  const TriangleMesh& mesh() const;

  /// Of `count` points, world units: into `inside` 1 or 0, into `distance` the distance to the
  /// nearest face in world units, by doubles, below zero inside. Either may be null. Throws
  /// Error(Invalid) for a point that is not finite, with its number; Error(Cancelled). Parallel;
  /// the same for any number of threads and order of points. About 0.5 us a point for `inside`,
  /// more where boundary edges are near, and 1 us for `distance`.
  void at(const Vec3d* points, std::size_t count, std::uint8_t* inside, double* distance,
          Progress& progress) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

} // namespace tetvdb
