// SPDX-License-Identifier: Apache-2.0
//
// AVS unstructured cell data (.inp, .avs), text and binary.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

/// Nodes and cells in file order; the material number is the region. Node and cell data become
/// attributes, of floats in binary and doubles in text files. Throws Error(Invalid) with line or
/// byte for an incomplete or inconsistent mesh.
/// Triangles and quadrilaterals keep their corners where `options.faces` asks for them.
CellMesh readUcd(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress);

/// Reads the whole mesh. Throws as readUcd() does.
bool ucdHasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
