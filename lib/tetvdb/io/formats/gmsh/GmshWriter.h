// SPDX-License-Identifier: Apache-2.0
//
// Writes tetrahedra to Gmsh's format (.msh), version 4.1, binary.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TetMesh.h"

#include <string>

namespace tetvdb {

/// Writes points as nodes 1, 2, ... and tets as elements 1, 2, ...; a volume entity and a block
/// of elements per region in order of their numbers, with its tets in order; a physical group
/// per region above 0, and attributes as $NodeData and $ElementData: values that are all NaN
/// are omitted, two components are extended to three and four to eight to nine, as Gmsh
/// requires; more than nine are not written. Whole or absent. Throws Error(Write) if it cannot
/// write.
void writeGmsh(const std::string& path, const TetMesh& mesh, Progress& progress);

} // namespace tetvdb
