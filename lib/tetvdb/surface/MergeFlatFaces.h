// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// Merges triangles of a closed manifold that lie nearly in a plane, by moving vertices onto
/// neighbours: vertices whose faces lie in one plane, and those on a straight crease between two
/// planes. Returns a bound of the distance between the old and the new surface, at most `tolerance`
/// (world units, above 0). Every step adds to that of its faces how far vertices of the old faces
/// around the moved vertex are from the planes of these faces; beyond the tolerance there is no
/// step. The result is manifold, its vertices are vertices of the input, and there are no new
/// intersections of faces (exact). `outward`: as SimplifyOptions::outward.
/// Leaves a mesh as it is that is not a closed manifold. About 2 us per face and thread: faces that
/// simplifySurface() need not look at, which takes ten times as long. Parallel by cubes of space;
/// independent of the number of threads.
double mergeFlatFaces(TriangleMesh& mesh, double tolerance, bool outward, Progress& progress);

} // namespace tetvdb
