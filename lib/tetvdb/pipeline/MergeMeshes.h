// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <vector>

namespace tetvdb {

/// Combines meshes in one: points, tets and cells follow each other in order, nothing is welded.
/// Cells of the second mesh are numbered after those of the first. Regions are kept by number, 0
/// for meshes without regions if others have them; of two names for one number, the first is kept,
/// with a warning in `report`. Attributes are kept if every mesh has them with the same name,
/// location, components and number type. A single mesh is returned unchanged. Throws Error(Limit)
/// above 2^32 - 2 points or cells.
TetMesh mergeMeshes(std::vector<TetMesh>&& meshes, Report& report);

/// The same for triangles. Units are kept if all meshes have the same. Otherwise, `report` receives
/// a warning, since lengths are not changed.
TriangleMesh mergeMeshes(std::vector<TriangleMesh>&& meshes, Report& report);

/// Whether all meshes have the same units; `report` receives a warning if they differ.
bool haveOneUnit(const std::vector<TriangleMesh>& meshes, Report& report);

} // namespace tetvdb
