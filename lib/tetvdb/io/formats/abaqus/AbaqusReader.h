// SPDX-License-Identifier: Apache-2.0
//
// The mesh of Abaqus and CalculiX decks (.inp).
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// Nodes and elements in file order, parts as placed by *INSTANCE. The element sets that a *SOLID
/// SECTION names, or all if there is none, become regions, numbered from 1 and named; an element in
/// several belongs to the last one. Steps, materials and loads are ignored. Shells, membranes,
/// rigid faces and plane elements keep their corners where `options.faces` asks for them. Throws
/// Error(Invalid) with line for generated nodes and elements, and for an incomplete or inconsistent
/// mesh; as pathWithin() does for a file that *INCLUDE or INPUT= names (each relative to the deck).
CellMesh readAbaqus(const Source& source, const ReadOptions& options, Report& report,
                    Progress& progress);

/// Reads the keywords up to the first type of elements with a volume.
bool abaqusHasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
