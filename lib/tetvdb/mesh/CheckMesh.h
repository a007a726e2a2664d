// SPDX-License-Identifier: Apache-2.0
//
// Whether a mesh that was made in memory meets the conditions of TriangleMesh and TetMesh. Readers
// return no other. Functions that take a mesh check it before they use its indices.
//
//   tetvdb::checkMesh(mesh);   // before its indices are used
#pragma once

#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// Throws Error(Invalid) where an index is not below the number of points, the number of indices is
/// not a multiple of three, or a coordinate is not finite; the message names the first such
/// triangle or point, whatever the number of threads. Parallel; reads the mesh once.
void checkMesh(const TriangleMesh& mesh);

/// The same for tets; and for the cells that they come from: cellOfTet as long as there are tets
/// (or empty), a region for every cell that a tet names (or none at all), quadratic cells whose
/// nodes are there. Lengths of attributes are checked where an array is used.
void checkMesh(const TetMesh& mesh);

} // namespace tetvdb
