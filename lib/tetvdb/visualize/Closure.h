// SPDX-License-Identifier: Apache-2.0
//
// Whether triangles have an inside that a cut can show.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstdint>

namespace tetvdb {

enum class Closure : std::uint8_t {
  /// There are edges with an odd number of faces: rays may slip out.
  Open,
  /// No such edges: points are inside where a ray to infinity meets an odd number of faces.
  Parity,
  /// Besides, every edge is run along as often one way as the other: inside is where the faces that
  /// a ray meets do not balance. Solids may overlap, and reversed shells are cavities.
  Winding
};

/// Of edges between equal points, of faces without repeated points. Deterministic; about 0.3 us and
/// 80 bytes a face. An empty mesh is Open.
Closure closureOf(const TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
