// SPDX-License-Identifier: Apache-2.0
//
// Abaqus and CalculiX decks (.inp), the mesh in them.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// Nodes and elements in file order, parts as placed by *INSTANCE. The element sets that a *SOLID
/// SECTION names, or all where there is none, become regions, numbered from 1 and named; an element
/// in several belongs to the one mentioned last. Steps, materials and loads are left out. Throws
/// Error(Invalid) with line for *INCLUDE and INPUT= (data in other files), for generated nodes and
/// elements, and for whatever is not a whole, consistent mesh.
CellMesh readAbaqus(const Source& source, const ReadOptions& options, Report& report,
                    Progress& progress);

} // namespace tetvdb
