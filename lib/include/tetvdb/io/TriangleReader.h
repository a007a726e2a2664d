// SPDX-License-Identifier: Apache-2.0
//
// Reads triangle meshes from files without changing faces.
//
//   tetvdb::TriangleMesh mesh = tetvdb::readTriangles("bracket.stl", report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <string>

namespace tetvdb {

struct Source;

/// Whether files of that format contain triangles (readTriangles() reads them) rather than solid
/// cells (readCells()) or both.
bool holdsTriangles(FileFormat format);

/// The same for one file: files without solid cells of formats with both contain triangles. False
/// for files that cannot be read.
bool holdsTriangles(const Source& source, Progress& progress);

/// Reads `path`: STL, OBJ, OFF, PLY, 3MF (all objects of its build) by our own readers; glTF, FBX,
/// DAE by assimp if the build includes it. The soup is unprocessed: vertices are not welded, and
/// degenerate, duplicate and non-manifold faces are kept. An invalid face (an index out of range, a
/// vertex that is not finite, fewer than three corners) is omitted, with a warning that counts them
/// and report.partial set. A vertex that is not finite is replaced by (0, 0, 0), so that indices do
/// not shift (an STL facet is omitted with its points). Whole faces of truncated files are kept,
/// with a warning and report.partial. Throws Error(Invalid) with file, line or byte and cause if
/// nothing can be read or no face is left, Error(Limit) if the memory does not suffice. Allocations
/// are bounded by the file's size.
TriangleMesh readTriangles(const std::string& path, Report& report, Progress& progress,
                           FileFormat* format = nullptr);

} // namespace tetvdb
