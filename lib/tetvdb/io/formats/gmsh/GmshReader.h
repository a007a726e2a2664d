// SPDX-License-Identifier: Apache-2.0
//
// Gmsh meshes (.msh), file versions 1, 2.x, 4.0 and 4.1, ASCII and binary in either byte order.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

class SpooledMesh;

/// Nodes and elements in file order. A solid cell's region is its physical group if any solid
/// cell has one, named by $PhysicalNames, and its geometrical entity otherwise. $NodeData and
/// $ElementData become attributes of doubles with their names, the last time step of each; NaN
/// for nodes and elements without a value. $ElementNodeData and all other sections are
/// ignored. Elements of higher order keep their corners; elements without volume keep no
/// nodes, but for triangles and quadrilaterals where `options.faces` asks for them. Throws
/// Error(Invalid) with line (ASCII) or byte (binary) for an incomplete or inconsistent mesh.
CellMesh readGmsh(const Source& source, const ReadOptions& options, Report& report,
                  Progress& progress);

/// Reads the file up to its first element with a volume. Throws Error(Invalid) where it is damaged
/// before.
bool gmshHasSolidCells(const Source& source, Report& report, Progress& progress);

/// The same, of linear cells alone, part by part: elements without a volume are left out, others
/// are Error(Invalid). Memory: a few million numbers; 4 bytes a node, and an element where there
/// are data of elements, whose numbers are not consecutive.
void spoolGmsh(const Source& source, const ReadOptions& options, SpooledMesh& mesh, Report& report,
               Progress& progress);

} // namespace tetvdb
