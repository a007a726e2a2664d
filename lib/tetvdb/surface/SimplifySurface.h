// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// Merges triangles of a closed manifold by moving vertices onto neighbours, cheapest first by
/// Garland and Heckbert's quadrics, as long as every vertex that ever was stays within
/// `tolerance` (world units) of the faces that took its place, and no face turns by more than 60
/// degrees in one step. The result is manifold again; its vertices are vertices of the input.
/// Deterministic: one thread, ties go to the lower vertex. About 3 us a face.
void simplifySurface(TriangleMesh& mesh, double tolerance, Progress& progress);

} // namespace tetvdb
