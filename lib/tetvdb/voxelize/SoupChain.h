// SPDX-License-Identifier: Apache-2.0
//
// The faces of a triangle soup as a chain, the input of the rasterisers of faces.
#pragma once

#include "tetvdb/geometry/BoundaryWinding.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/SoupBoundary.h"

#include <vector>

namespace tetvdb {

/// The faces of `mesh`, each once; `snapped` are its points. Throws Error(Limit) for a face longer
/// than kMaxTetExtent.
Boundary soupFaces(const TriangleMesh& mesh, const SnappedMesh& snapped);

/// The boundary edges of a soup, in place.
std::vector<BoundaryEdge> boundaryEdges(const std::vector<IndexedBoundaryEdge>& edges,
                                        const SnappedMesh& snapped);

/// The winding number of points around a soup, from its boundary edges.
BoundaryWinding boundaryWinding(const std::vector<IndexedBoundaryEdge>& edges,
                                const SnappedMesh& snapped);

} // namespace tetvdb
