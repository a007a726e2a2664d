// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct SmoothOptions {
  double distance = 0;        ///< world units: no vertex moves farther than this from its place
  double featureDegrees = 60; ///< vertices on such edges stay (FeatureEdges.h); 180: none do
  double volumeShare = 1e-3;  ///< of the volume: it changes by no more
};

struct SmoothCounts {
  std::size_t moved = 0;  ///< vertices
  std::size_t held = 0;   ///< vertices on feature edges
  std::size_t backed = 0; ///< vertices that moved less, or not, as faces would have crossed
  double largest = 0;     ///< distance that a vertex moved
};

/// Evens out a closed manifold by Taubin's smoothing (1995): steps towards the neighbours' mean and
/// larger ones away from it, so that the surface does not shrink, both along the normals. Topology
/// stays. Where a face
/// would turn over or meet others, its vertices go back towards their places until it does not;
/// faces that meet others in the input may still. Vertices that were different as 32-bit floats
/// stay so. Parallel crossing tests, the same for any number of threads; about 5 us a face. Throws
/// Error(Usage) for a distance that is not above 0, Error(Invalid) for a mesh that is not closed
/// and manifold.
SmoothCounts smoothSurface(TriangleMesh& mesh, const SmoothOptions& options, Progress& progress);

} // namespace tetvdb
