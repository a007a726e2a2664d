// SPDX-License-Identifier: Apache-2.0
//
// Reads meshes of linear cells that may be larger than memory.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/mesh/SpooledMesh.h"

#include <string>

namespace tetvdb {

/// Reads `path` into `mesh`, which is empty, and finishes it: as readCells() and splitCells()
/// would, of files that hold linear tets, hexahedra, wedges, pyramids and prisms alone besides
/// cells without a volume, and whose format can be read part by part (FormatUse::SpoolCells). The
/// mesh keeps the arrays that are asked for, and its regions. Throws as readCells(), Error(Invalid)
/// for other cells, Error(Usage) for other formats, Error(Write) where there is no room for the
/// temporary files.
void spoolCells(const std::string& path, const ReadOptions& options, SpooledMesh& mesh,
                FileFormat& format, Report& report, Progress& progress);

/// Throws the Error(Invalid) for cells that have no place in a spooled mesh.
[[noreturn]] void refuseToSpool(const std::string& where, const std::string& kind);

} // namespace tetvdb
