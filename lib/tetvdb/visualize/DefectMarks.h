// SPDX-License-Identifier: Apache-2.0
//
// Defects of a mesh, for pictures; surface/SurfaceDefects.h counts the same.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/visualize/LineDrawable.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

struct DefectMarks {
  std::vector<Line> lines;           ///< red: edges of one face; yellow: of three faces or more
  std::vector<std::uint8_t> flipped; ///< by face: 1 where cleanTriangles() reverses it
  std::size_t openEdges = 0, nonManifoldEdges = 0, flippedFaces = 0;
};

/// Edges are those between welded (equal) points, of faces without repeated points. Deterministic;
/// about 1 us and 150 bytes a face.
DefectMarks markDefects(const TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
