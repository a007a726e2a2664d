// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct SmoothOptions {
  double distance = 0;        ///< world units: limit of the displacement of each vertex
  double featureDegrees = 60; ///< vertices on sharper edges are fixed (FeatureEdges.h); 180: none
  double volumeShare = 1e-3;  ///< limit of the relative change of the volume
};

struct SmoothCounts {
  std::size_t moved = 0;  ///< moved vertices
  std::size_t held = 0;   ///< fixed vertices on feature edges
  std::size_t backed = 0; ///< vertices moved less, or not at all, to avoid intersections
  double largest = 0;     ///< largest displacement, world units
};

/// Smooths a closed manifold by Taubin's method (1995): steps toward the mean of the neighbours
/// alternate with larger steps away from it, along the normals, so that the surface does not
/// shrink. The topology does not change. If a face would turn over or intersect others, its
/// vertices are moved back toward their initial positions until it does not; intersections of the
/// input may remain. Vertices that differ as 32-bit floats still differ afterwards. Intersection
/// tests are parallel; the result does not depend on the number of threads. About 5 us per face.
/// Throws Error(Usage) unless `distance` is above 0, and Error(Invalid) for a mesh that is not a
/// closed manifold.
SmoothCounts smoothSurface(TriangleMesh& mesh, const SmoothOptions& options, Progress& progress);

} // namespace tetvdb
