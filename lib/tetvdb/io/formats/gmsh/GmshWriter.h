// SPDX-License-Identifier: Apache-2.0
//
// Tetrahedra to Gmsh's format (.msh), version 4.1, binary.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TetMesh.h"

#include <string>

namespace tetvdb {

/// Writes points as nodes 1, 2, ... and tets as elements 1, 2, ...; a volume entity and a block of
/// elements for each region in order of their numbers, in it the tets in their order; a physical
/// group for each region above 0, and attributes as $NodeData and $ElementData: values
/// that are all NaN are left out, two components are filled up to three and four to eight up to
/// nine, as Gmsh wants them; more than nine are not written. Whole or absent. Throws Error(Write)
/// where it cannot write.
void writeGmsh(const std::string& path, const TetMesh& mesh, Progress& progress);

} // namespace tetvdb
