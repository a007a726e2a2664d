// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct SimplifyOptions {
  /// World units: how far the two surfaces may be from each other; 0: as far as it takes.
  double tolerance = 0;
  /// Ends at no more faces than that; 0: as few as the tolerance allows.
  std::size_t faces = 0;
  /// Edges at which faces meet at more than this from flat are kept: vertices on them move along
  /// them alone (FeatureEdges.h). Where `faces` cannot be reached so, they are given up. 180: none.
  double featureDegrees = 180;
};

/// Merges triangles of a closed manifold by moving vertices onto neighbours, cheapest first by
/// Garland and Heckbert's quadrics, as long as both surfaces stay within the tolerance of each
/// other. That is looked at in points: every vertex and every edge's middle of the old surface
/// (fewer under large flat faces), which must have a new face near that looks the same way, and
/// each new face's middle and new side; they are held to 0.65 of the tolerance. The result is
/// manifold again; its vertices are vertices of the input, and no face crosses another that did not
/// before (exact). Parallel without `faces`: within cubes of space first, then across their sides;
/// ties to the lower vertex; the same for any number of threads. About 12 us a face and thread.
/// Throws Error(Usage) without tolerance and faces, Error(Invalid) for a mesh that is not closed
/// and manifold. The result may have more than `faces` where a step more would break one of these.
void simplifySurface(TriangleMesh& mesh, const SimplifyOptions& options, Progress& progress);

} // namespace tetvdb
