// SPDX-License-Identifier: Apache-2.0
//
// Triangles into .3mf.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <string>

namespace tetvdb {

/// One object, built once, numbers as they are; `units` is kept, millimetre where there is none or
/// 3MF has none of that name. 3MF has no faces that name a point twice: they are left out. The same
/// mesh gives the same bytes. Throws Error(Limit) for more points or faces than readers count and
/// more than 4 GiB of text, Error(Invalid) where no face is left, Error(Write).
void writeThreeMf(const std::string& path, const TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
