// SPDX-License-Identifier: Apache-2.0
//
// Hexahedra, wedges, pyramids and prisms into tets, from their smallest vertices.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/CellMesh.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// Faces of a cell type by local corner, oriented alike as seen from outside.
struct CellShape {
  int corners;
  int tets; ///< how many a cell without repeated corners is cut into
  std::vector<std::vector<int>> faces;
};

/// Null for types that have no shape of their own: tets, polyhedra, what is not read.
const CellShape* shapeOf(CellType type);

/// Adds the tets of one cell to `tets`; returns whether their orientations differ, as they do where
/// the cell is not convex. See splitCells() for the rule.
bool splitByShape(const CellShape& shape, const std::uint32_t* nodes,
                  const std::vector<Vec3d>& points, std::vector<std::uint32_t>& tets);

} // namespace tetvdb
