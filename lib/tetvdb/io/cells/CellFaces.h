// SPDX-License-Identifier: Apache-2.0
//
// Triangles of meshes that a file stores as cells without volume.
#pragma once

#include "tetvdb/mesh/CellMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <string>

namespace tetvdb {

/// Whether any cell has a volume.
bool hasSolidCells(const CellMesh& mesh);

/// Whether any cell is a polygon whose nodes were kept (ReadOptions::faces).
bool hasPolygons(const CellMesh& mesh);

/// The polygons as fans from their first corner, in the file's order. Throws Error(Invalid) for
/// `path` if the mesh has solid cells, whose faces these would be, or no polygons.
TriangleMesh trianglesOfFaces(CellMesh&& mesh, const std::string& path);

} // namespace tetvdb
