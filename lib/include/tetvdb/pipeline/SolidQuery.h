// SPDX-License-Identifier: Apache-2.0
//
// Tests whether points are inside a solid, and computes signed distances to its surface.
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

/// A point is inside if the winding number of the faces is above 0.5, as in voxelize(). Corners and
/// points are rounded to a lattice of 2^37 to 2^38 units along the box's longest side. For a closed
/// mesh, every result is exact on that lattice, and a point on a face belongs to one of its sides
/// by the rule of geometry/Ownership.h. For an open mesh, the sums over its boundary edges are
/// rounded: points with a winding number within 1e-3 of 0.5 may be on either side. Points farther
/// from the box than its longest side are outside.
///
/// Immutable after construction; at() is thread-safe.
class SolidQuery {
public:
  /// `mesh` must be cleaned (surface/CleanTriangles.h). Throws Error(Invalid) as checkMesh() does,
  /// and for a mesh without faces. About 1 us per face.
  SolidQuery(TriangleMesh mesh, Progress& progress);
  ~SolidQuery();
  SolidQuery(const SolidQuery&) = delete;
  SolidQuery& operator=(const SolidQuery&) = delete;

  /// Number of boundary edges of the mesh: 0 if it is closed.
  std::size_t openEdges() const;
  const TriangleMesh& mesh() const;

  /// For `count` points, world units: sets `inside` to 1 or 0, and `distance` to the distance to
  /// the nearest face in world units, in doubles, negative inside. Either may be null. Throws
  /// Error(Invalid) for a point that is not finite, with its number; Error(Cancelled). Parallel;
  /// independent of the number of threads and the order of points. About 0.5 us per point for
  /// `inside`, more close to boundary edges, and 1 us for `distance`.
  void at(const Vec3d* points, std::size_t count, std::uint8_t* inside, double* distance,
          Progress& progress) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

} // namespace tetvdb
