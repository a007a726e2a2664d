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

/// The centroid covering joins every face to the centre of the points. As a chain, what is left of
/// all these tets' faces is the soup and a face from every edge of its rim to the centre: adds the
/// centre to `snapped` and these faces to `chain`.
void closeToCentre(const std::vector<IndexedRimEdge>& rim, SnappedMesh& snapped, Boundary& chain);

/// The boundary edges of a soup, in place.
std::vector<RimEdge> boundaryEdges(const std::vector<IndexedRimEdge>& rim,
                                   const SnappedMesh& snapped);

/// The winding number of a soup's rim.
RimWinding windingOfRim(const std::vector<IndexedRimEdge>& rim, const SnappedMesh& snapped);

} // namespace tetvdb
