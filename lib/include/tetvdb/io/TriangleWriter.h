// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <string>

namespace tetvdb {

/// Whether writeTriangles() supports the path's extension.
bool writesTriangles(const std::string& path);

/// Writes `mesh` as .stl (binary), .obj, .ply (binary, double), .off or .3mf, by the path's
/// extension (any case). Whole or absent. Throws Error(Usage) for another extension, Error(Limit)
/// for more faces than the format can count, Error(Write) if the file cannot be written. Doubles
/// read back the same, in STL as floats. Faces that name a point twice are omitted in 3MF, which
/// does not permit them.
void writeTriangles(const std::string& path, const TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
