// SPDX-License-Identifier: Apache-2.0
//
// Reads tetrahedral and mixed solid meshes from files.
//
//   tetvdb::Progress progress;
//   tetvdb::Report report;
//   tetvdb::CellMesh cells = tetvdb::readCells("bracket.vtu", {}, report, progress);
//   tetvdb::TetMesh tets = tetvdb::splitCells(std::move(cells), {}, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/mesh/CellMesh.h"

#include <string>

namespace tetvdb {

/// Reads `path`. Throws Error(Invalid) with file, line or byte offset and cause for incomplete
/// meshes: missing or truncated data, indices out of range, coordinates that are not finite, counts
/// that exceed the file's size, no solid cells. Recoverable faults are warnings in `report`. Cost:
/// about the time to read the bytes and parse the numbers once.
CellMesh readCells(const std::string& path, const ReadOptions& options, Report& report,
                   Progress& progress, FileFormat* format = nullptr);

} // namespace tetvdb
