// SPDX-License-Identifier: Apache-2.0
//
// The faces of a triangle soup as a chain: what the rasterisers of faces take.
#pragma once

#include "tetvdb/geometry/RimWinding.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/SoupRim.h"

#include <vector>

namespace tetvdb {

/// The faces of `mesh`, each once; `snapped` are its points. Throws Error(Limit) for a face longer
/// than kMaxTetExtent.
Boundary soupFaces(const TriangleMesh& mesh, const SnappedMesh& snapped);

/// The boundary edges of a soup, in place.
std::vector<RimEdge> boundaryEdges(const std::vector<IndexedRimEdge>& rim,
                                   const SnappedMesh& snapped);

/// The winding number of a soup's rim.
RimWinding windingOfRim(const std::vector<IndexedRimEdge>& rim, const SnappedMesh& snapped);

} // namespace tetvdb
