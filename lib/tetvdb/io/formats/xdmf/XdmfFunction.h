// SPDX-License-Identifier: Apache-2.0
//
// XDMF's finite-element functions, as written by FEniCS's write_checkpoint(): numbers by degrees of
// freedom instead of points or cells.
#pragma once

#include "tetvdb/io/formats/xdmf/XdmfMarkup.h"
#include "tetvdb/mesh/Attribute.h"
#include "tetvdb/mesh/CellMesh.h"

#include <cstddef>
#include <optional>
#include <string>

namespace tetvdb {

/// A function over tetrahedra that can become an array.
struct XdmfFunction {
  Attribute::On on = Attribute::On::Points;
  std::size_t degree = 1;
  std::size_t dofs = 4; ///< of a cell, for each component
};

/// For an <Attribute>: Lagrange functions of any degree, which have their values at the corners
/// among their numbers, and piecewise constants. None for others and for other attributes.
std::optional<XdmfFunction> xdmfFunction(pugi::xml_node attribute);

/// The array of a function over `mesh`, whose cells are all tetrahedra of four nodes: `numbers` by
/// degree of freedom, and for every cell its degrees of freedom, component by component, the
/// corners' first (Unified Form-assembly Code, "UFC Specification and User Manual" 1.1, 2009, 5.3).
/// Points without a cell have NaN. Throws Error(Invalid) with `where` for numbers that do not match
/// the mesh.
Attribute arrayOf(const XdmfFunction& function, const Attribute::Values& cellDofs,
                  const Attribute::Values& numbers, const CellMesh& mesh, const std::string& where);

} // namespace tetvdb
