// SPDX-License-Identifier: Apache-2.0
//
// Writes triangles to .3mf.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/MeshPart.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <string>
#include <vector>

namespace tetvdb {

/// One object, built once, numbers unchanged; `units` is kept, millimetre if there is none or 3MF
/// does not know it. Faces that name a point twice are omitted, since 3MF does not permit them. The
/// same mesh gives the same bytes. Throws Error(Limit) for more points or faces than readers
/// support and more than 4 GiB of text, Error(Invalid) if no face is left, Error(Write).
void writeThreeMf(const std::string& path, const TriangleMesh& mesh, Progress& progress);

/// The same with one object per mesh, in their order; those of one assembly are components of an
/// object of its name, which is built. The units are those of the first mesh.
void writeThreeMf(const std::string& path, const std::vector<NamedMesh>& objects,
                  Progress& progress);

} // namespace tetvdb
