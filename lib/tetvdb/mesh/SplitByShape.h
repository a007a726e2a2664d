// SPDX-License-Identifier: Apache-2.0
//
// Hexahedra, wedges, pyramids and prisms into tets, from their smallest vertices.
#pragma once

#include "tetvdb/core/Report.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/CellMesh.h"
#include "tetvdb/mesh/CurvedShape.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
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
bool splitByShape(const CellShape& shape, const std::uint32_t* nodes, const Vec3d* points,
                  std::vector<std::uint32_t>& tets);

/// A hexahedron, wedge or pyramid, whose values at points are those of its shape functions.
class LinearCell {
public:
  /// `shape` is cornerShape(type).
  LinearCell(CurvedShape shape, CellType type, const std::uint32_t* corners);

  CurvedShape shape() const { return shape_; }
  /// In the order of the shape.
  const std::uint32_t* begin() const { return nodes_.data(); }
  const std::uint32_t* end() const { return nodes_.data() + count_; }
  /// Which nodes of the cell the corners of a tet of it are.
  std::array<std::uint8_t, 4> placesOf(const std::uint32_t* tet) const;

private:
  CurvedShape shape_;
  std::size_t count_;
  std::array<std::uint32_t, 8> nodes_{};
};

/// Warns of so many cells for which splitByShape() returned true.
void warnConcave(std::size_t cells, Report& report);

} // namespace tetvdb
