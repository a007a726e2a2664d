// SPDX-License-Identifier: Apache-2.0
//
// The simplicial covering of Ogayar-Anguita et al., "Voxelization of solids using simplicial
// coverings" (2004), a peer of the paper: every face is joined to the centroid of the points, and a
// voxel is inside where an odd number of these tets holds it. Right for closed meshes, wrong near
// the holes of open ones.
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb::bench {

/// The sum modulo 2 of the boundaries of all the tets: the faces of `mesh`, and one from every edge
/// of an odd number of faces to the centroid. Its voxels by InsideRule::Parity are those of the
/// covering.
TriangleMesh centroidCovering(const TriangleMesh& mesh);

} // namespace tetvdb::bench
