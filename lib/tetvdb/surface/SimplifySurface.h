// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct SimplifyOptions {
  /// World units: limit of the distance between the two surfaces; 0: no limit.
  double tolerance = 0;
  /// Stops at this number of faces; 0: continues as long as the tolerance allows.
  std::size_t faces = 0;
  /// Edges whose faces deviate from a plane by more than this are kept: their vertices move along
  /// them only (FeatureEdges.h). They are released if `faces` cannot be reached otherwise. 180:
  /// none.
  double featureDegrees = 180;
  /// The surface moves to the side alone that its faces look to, decided exactly: the solid behind
  /// them grows, and loses nothing. Of the old surface only vertices are looked at then.
  bool outward = false;
};

/// Merges triangles of a closed manifold by moving vertices onto neighbours, the cheapest first by
/// Garland and Heckbert's quadrics, while both surfaces stay within the tolerance of each other.
/// The distance is tested at points: every vertex and every midpoint of an edge of the input (fewer
/// under large flat faces) must have a new face close by with a similar normal, and so must the
/// centroid and the new side of each new face; these points are held to 0.65 of the tolerance. The
/// result is manifold, its vertices are vertices of the input, and there are no new intersections
/// of faces (exact). Parallel without `faces`: first within cubes of space, then across their
/// sides. Ties are decided by the lower vertex; independent of the number of threads. About 12 to
/// 17 us per face and thread, less where faces are coplanar. Throws Error(Usage) without tolerance
/// and faces, Error(Invalid) for a mesh that is not a closed manifold. The result has more than
/// `faces` if any further step would violate these conditions.
void simplifySurface(TriangleMesh& mesh, const SimplifyOptions& options, Progress& progress);

} // namespace tetvdb
