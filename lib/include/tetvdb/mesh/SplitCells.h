// SPDX-License-Identifier: Apache-2.0
//
// Solid cells into tetrahedra, neighbours agreeing on every shared face.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/CellMesh.h"
#include "tetvdb/mesh/TetMesh.h"

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace tetvdb {

/// Which cells to keep. All filters must accept a cell.
struct CellFilter {
  std::vector<std::string> regions; ///< numbers or names to keep; empty: all
  std::vector<std::string> exclude; ///< numbers or names to drop
  /// World space; a cell is kept where its own box meets this one. Infinite: all.
  Vec3d boxMin{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
               -std::numeric_limits<double>::infinity()};
  Vec3d boxMax{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
               std::numeric_limits<double>::infinity()};
};

/// "694 triangles, 12 lines": what a mesh holds, for messages.
std::string describeCells(const CellMesh& mesh);

/// Splits the solid cells of `mesh` into tets and moves its points and attributes over.
///
/// A cell is cut from its smallest vertex, and so is each of its faces, where vertices are ordered
/// by position (x, then y, then z; the index for coincident points): no point is added, neighbours
/// cut a shared face alike, and renumbering changes nothing. (Dompierre et al. 1999, "How to
/// Subdivide Pyramids, Prisms and Hexahedra into Tetrahedra", with positions in place of indices.)
/// Polyhedra that are not star-shaped about that vertex get a point within, their faces of five
/// corners and more that are not flat one each, all with values; those whose faces do not close are
/// skipped (mesh/SplitPolyhedron.h).
///
/// Where the mesh has arrays of points, TetMesh::curved says what the shape functions of hexahedra,
/// wedges and pyramids need; prisms and polyhedra are interpolated by their tets.
///
/// A mesh whose solid cells are all quadratic and keep their nodes (mesh/CurvedShape.h) is cut at
/// these (mesh/CutQuadratic.h): it follows curved edges, and TetMesh::curved has what shape
/// functions need. Points are added, with values, at the centres of faces and hexahedra that have
/// no node there. Where other cells are among them, or nodes are not kept, quadratic cells are
/// taken by their corners.
///
/// `report` receives a warning for skipped cells (and `partial`, since they leave holes), for
/// quadratic cells taken by their corners, for cells that are not convex, and for a region that is
/// named in the mesh but has no solid cells.
/// Throws Error(Usage) for a region that the mesh does not have, Error(Invalid) where no solid cell
/// is left, Error(Limit) above 2^32 - 2 tets. Linear time; no more memory than its result for a
/// mesh of tets alone.
TetMesh splitCells(CellMesh&& mesh, const CellFilter& filter, Report& report, Progress& progress);

} // namespace tetvdb
