// SPDX-License-Identifier: Apache-2.0
//
// Triangles into .3mf.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/MeshPart.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <string>
#include <vector>

namespace tetvdb {

/// One object, built once, numbers as they are; `units` is kept, millimetre where there is none or
/// 3MF has none of that name. 3MF has no faces that name a point twice: they are left out. The same
/// mesh gives the same bytes. Throws Error(Limit) for more points or faces than readers count and
/// more than 4 GiB of text, Error(Invalid) where no face is left, Error(Write).
void writeThreeMf(const std::string& path, const TriangleMesh& mesh, Progress& progress);

/// The same with an object for each mesh, in their order; those of one assembly are components of
/// an object of its name, which is what is built. The units are the first mesh's.
void writeThreeMf(const std::string& path, const std::vector<NamedMesh>& objects,
                  Progress& progress);

} // namespace tetvdb
