// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/io/cells/CellRuns.h"

#include <cgnslib.h>
#include <cstdint>

namespace tetvdb {

/// What an element type with a fixed number of nodes is.
CellKind cgnsElement(ElementType_t type);

/// Corners of the polygon that a flat element is; 0 for points and lines.
std::uint32_t polygonCorners(const CellKind& kind);

} // namespace tetvdb
