// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb::vtk {

/// The array by which VTK hides parts of a structured grid (vtkDataSetAttributes::GhostArrayName).
inline constexpr const char* kGhostArray = "vtkGhostType";

/// Removes the hidden cells of a structured grid, with their values: those whose own ghost type, or
/// that of one of their points, says hidden. Points are kept, the arrays of ghost types are
/// removed. `mesh` has one run of cells; one without nodes is left as it is.
void removeHiddenCells(CellMesh& mesh);

} // namespace tetvdb::vtk
