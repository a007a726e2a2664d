// SPDX-License-Identifier: Apache-2.0
//
// Reads triangles from .stl, text and binary.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <string_view>

namespace tetvdb {

/// A soup: three points per face, in file order, solids one after the other. Binary or text is
/// decided by size, then by content, not by "solid". Facets with a corner that is not finite are
/// omitted; whole facets of a truncated file are kept (`truncated`). Throws Error(Invalid) if no
/// facet is left.
TriangleMesh readStl(const Source& source, Report& report, Progress& progress);

/// Whether the count of facets in a binary header matches the number of bytes and is not 0.
bool isBinaryStlBySize(std::string_view bytes);
/// Whether the first bytes are text with the words of an STL file.
bool isTextStl(std::string_view bytes);

} // namespace tetvdb
