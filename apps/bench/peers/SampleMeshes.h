// SPDX-License-Identifier: Apache-2.0
//
// Meshes of any size to measure with.
#pragma once

#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb::bench {

/// A block of Kuhn cubes, inner points moved by up to a fifth of a cube; about `tets` tets.
TetMesh blockMesh(double tets);
/// A ball of about `tets` tets.
TetMesh ballMesh(double tets);
/// A sphere with bumps of a twentieth of its radius; about `faces` faces.
TriangleMesh bumpySphere(double faces);

/// Numbers the tets in a cell array "tet_id", int32, for VTK to look up.
void numberCells(TetMesh& mesh);

} // namespace tetvdb::bench
