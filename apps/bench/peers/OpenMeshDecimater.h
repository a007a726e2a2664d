// SPDX-License-Identifier: Apache-2.0
//
// OpenMesh's own decimater, as a program that links OpenMesh would call it.
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb::bench {

/// DecimaterT with its quadric module for the order, and its Hausdorff and normal-flipping modules
/// as limits, on a mesh in double; returns the faces that are left. `seconds` becomes the user CPU
/// time of decimate() and of building the half-edge mesh.
std::size_t decimateByOpenMesh(const TriangleMesh& mesh, double tolerance, double* seconds);

/// User CPU time of this process so far, of all its threads.
double userSeconds();

} // namespace tetvdb::bench
