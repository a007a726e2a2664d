// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/io/cells/CellRuns.h"

#include <cstdint>

namespace tetvdb {

/// The kind of Gmsh's element type `type` (its reference manual's list); null for one that is
/// unknown or whose number of nodes varies. Gmsh numbers corners first, and as VTK does;
/// quadratic cells keep all nodes, in an order of Gmsh's own (CellKind::order).
const CellKind* gmshElement(std::int64_t type);

/// The kind of a triangle or quadrilateral of first or second order, with its corners; null for
/// other types.
const CellKind* gmshFace(std::int64_t type);

} // namespace tetvdb
