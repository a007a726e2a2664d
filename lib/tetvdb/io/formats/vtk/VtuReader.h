// SPDX-License-Identifier: Apache-2.0
//
// VTK's XML unstructured grids (.vtu): ascii, inline base64 and appended data (raw or base64),
// plain or compressed by zlib, lz4 or lzma; header_type UInt32 or UInt64; either byte order.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {

class SpooledMesh;

/// The mesh of an UnstructuredGrid or PolyData: points, cells in file order (the Pieces one after
/// the other, points not merged), and the point and cell arrays that every Piece has. Field data is
/// ignored. With `options.attributes` false, only integer cell arrays are decoded besides the mesh.
/// Throws Error(Invalid) with file and byte for an incomplete or inconsistent mesh. Compressed
/// blocks are decoded in parallel.
CellMesh readVtu(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress);

/// The same, of linear cells alone, part by part: cells without a volume are left out, others are
/// Error(Invalid). Memory: a few million numbers, and the largest compressed block.
void spoolVtu(const Source& source, const ReadOptions& options, SpooledMesh& mesh, Report& report,
              Progress& progress);

/// Whether an unstructured grid has solid cells: reads only the types of cells.
bool vtuHasSolidCells(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
