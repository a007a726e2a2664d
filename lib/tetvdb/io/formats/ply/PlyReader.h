// SPDX-License-Identifier: Apache-2.0
//
// Triangles from .ply, text and binary.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// Element `vertex` by its x, y, z of any type, elements `face` and `tristrips` by their
/// vertex_indices (or vertex_index); everything else is passed over. Rows that the header declares
/// but the file does not hold are missed with the warning `truncated`. Throws Error(Invalid) with
/// the line for a header that says otherwise and where no face is left.
TriangleMesh readPly(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
