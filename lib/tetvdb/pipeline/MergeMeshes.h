// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <vector>

namespace tetvdb {

/// Lays meshes side by side as one: points, tets and cells follow each other in order, nothing is
/// welded. Cells of the second mesh are numbered on from those of the first. Regions are kept by
/// number, 0 for meshes that have none while others do; of two names for one number the first stays
/// and `report` gets a warning. Attributes stay where every mesh has them with the same name,
/// place, components and number type. A single mesh is passed through. Throws Error(Limit) above
/// 2^32 - 2 points or cells.
TetMesh mergeMeshes(std::vector<TetMesh>&& meshes, Report& report);

/// The same for triangles. Units are kept where all meshes have the same; where they differ
/// `report` gets a warning, since lengths are not changed.
TriangleMesh mergeMeshes(std::vector<TriangleMesh>&& meshes, Report& report);

/// Whether all meshes have the same units; `report` gets a warning where they differ.
bool haveOneUnit(const std::vector<TriangleMesh>& meshes, Report& report);

} // namespace tetvdb
