// SPDX-License-Identifier: Apache-2.0
//
// Triangle meshes from files, every face as it stands.
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

/// Whether files of that format hold triangles (readTriangles() reads them) rather than solid cells
/// (readCells()) or both.
bool holdsTriangles(FileFormat format);

/// The same of one file: of formats that hold both, files without solid cells hold triangles. False
/// for files that cannot be read.
bool holdsTriangles(const Source& source, Progress& progress);

/// Reads `path`: STL, OBJ, OFF, PLY, 3MF (as its build places it) by readers of our own;
/// glTF, FBX, DAE by assimp where the build has it. The soup is raw: vertices are not welded, no
/// face is dropped for being degenerate, duplicate or non-manifold. A face that has no meaning (an
/// index out of range, a vertex that is not finite, fewer than three corners) is left out, with a
/// warning that counts them and report.partial set; a vertex that is not finite keeps its place as
/// (0, 0, 0), so that indices do not shift (an STL's facet goes with its points). Truncated files
/// are salvaged as far as whole faces go, with a warning and report.partial. Throws Error(Invalid)
/// with file, line or byte and cause where nothing can be read or no face is left, Error(Limit)
/// where memory does not do. What is allocated is bounded by the file's size.
TriangleMesh readTriangles(const std::string& path, Report& report, Progress& progress,
                           FileFormat* format = nullptr);

} // namespace tetvdb
