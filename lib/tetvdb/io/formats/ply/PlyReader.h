// SPDX-License-Identifier: Apache-2.0
//
// Reads triangles from .ply, text and binary.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// Element `vertex` by its x, y, z of any type, elements `face` and `tristrips` by their
/// vertex_indices (or vertex_index); everything else is skipped. Missing rows of a truncated file
/// give the warning `truncated`. Throws Error(Invalid) with the line for other headers, and if no
/// face is left.
TriangleMesh readPly(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
