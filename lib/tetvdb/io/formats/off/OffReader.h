// SPDX-License-Identifier: Apache-2.0
//
// Reads triangles from Geomview .off, text and binary.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <string_view>

namespace tetvdb {

/// Points and faces; normals, colours and texture coordinates ([ST][C][N]OFF) are skipped. Missing
/// faces of a truncated file give the warning `truncated`. Throws Error(Invalid) for more vertices
/// than the file can hold, and if no face is left.
TriangleMesh readOff(const Source& source, Report& report, Progress& progress);

/// Whether a text begins with OFF, COFF, NOFF and so on, possibly with counts attached.
bool hasOffKeyword(std::string_view text);

} // namespace tetvdb
