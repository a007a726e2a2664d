// SPDX-License-Identifier: Apache-2.0
//
// Whether triangles have an inside, which a cut can show.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstdint>

namespace tetvdb {

enum class Closure : std::uint8_t {
  /// There are edges with an odd number of faces: rays may pass between them.
  Open,
  /// No such edges: points are inside where a ray to infinity meets an odd number of faces.
  Parity,
  /// Besides, every edge has as many faces in one direction as in the other: a point is inside
  /// where
  /// the signed count of faces along a ray is not zero. Solids may overlap, and reversed shells are
  /// cavities.
  Winding
};

/// Of edges between equal points, of faces without repeated points. Deterministic; about 0.3 us and
/// 80 bytes a face. An empty mesh is Open.
Closure closureOf(const TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
