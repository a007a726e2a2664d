// SPDX-License-Identifier: Apache-2.0
//
// Quadratic cells, and linear ones but tets: their nodes, the places of these in the reference
// cell, their shape functions.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace tetvdb {

enum class CellType : std::uint8_t;

/// Nodes are VTK's (vtkQuadraticTetra.h and so on): corners, then mids of edges, of faces, of the
/// cell. Reference cells, x, y, z:
/// - tet: corners (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)
/// - hexahedron: -1 to 1
/// - wedge: the triangle (0, 0), (1, 0), (0, 1) in x and y, -1 to 1 in z
/// - pyramid: base corners (1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), apex (0, 0, 1)
enum class CurvedShape : std::uint8_t {
  Tet10,
  Hex20,
  Hex27,
  Wedge15,
  Wedge18,
  Pyramid13,
  Pyramid14,
  Hex8,
  Wedge6,
  Pyramid5
};

constexpr std::size_t kMaxCurvedNodes = 27;

/// The shape of a quadratic cell with so many nodes; none where only its corners are used.
std::optional<CurvedShape> curvedShape(CellType type, std::size_t nodes);
/// The shape that a cell's corners make: of hexahedra, wedges and pyramids, and of VTK's voxels,
/// whose third and fourth, seventh and eighth nodes are those of a hexahedron exchanged. None of
/// tets, whose shape functions are their weights, and of other cells.
std::optional<CurvedShape> cornerShape(CellType type);
/// Whether the shape has no nodes but its corners.
bool isLinear(CurvedShape shape);

/// How many nodes a cell has.
std::size_t nodeCount(CurvedShape shape);

/// Places of a shape: its nodes, and then the centres of faces and cell that it has no nodes at,
/// where it is cut too (mesh/CutQuadratic.h).
std::size_t placeCount(CurvedShape shape);
/// Coordinates of place `i` in the reference cell.
Vec3d placeOf(CurvedShape shape, std::size_t i);

/// The values of all nodes' shape functions at a point of the reference cell: nodeCount() of them.
/// They sum to 1, but for rounding. Wedges and hexahedra without nodes in their faces have
/// serendipity functions, those with them tensor products; pyramids have rational ones (Bedrosian
/// 1992, "Shape functions and integration formulas for three-dimensional finite element analysis").
/// All of quadratic cells contain the quadratic polynomials in the reference coordinates. Those of
/// linear cells are VTK's: trilinear in hexahedra (vtkHexahedron), linear times linear in wedges
/// (vtkWedge), bilinear in every section parallel to the base of a pyramid (vtkPyramid); they
/// contain the linear polynomials.
void shapeFunctions(CurvedShape shape, const Vec3d& at, double* values);
/// Their derivatives too: gradients[node][axis].
void shapeFunctions(CurvedShape shape, const Vec3d& at, double* values,
                    std::array<double, 3>* gradients);

} // namespace tetvdb
