// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// Merges triangles of a closed manifold by moving vertices onto neighbours, cheapest first by
/// Garland and Heckbert's quadrics, as long as both surfaces stay within `tolerance` (world units)
/// of each other. That is looked at in points: every vertex and every edge's middle of the old
/// surface (fewer under large flat faces), which must have a new face near that looks the same way,
/// and each new face's middle and new side; they are held to 0.65 of the tolerance. The result is
/// manifold again; its vertices are vertices of the input. Parallel: within cubes of space first,
/// then across their sides, ties to the lower vertex; the same for any number of threads. About 10
/// us a face and thread. Throws Error(Invalid) for a mesh that is not closed and manifold.
void simplifySurface(TriangleMesh& mesh, double tolerance, Progress& progress);

} // namespace tetvdb
