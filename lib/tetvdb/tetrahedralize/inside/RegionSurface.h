// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

/// Where the regions of a tet mesh end. Tets of region kOutsideRegion count as none.
struct RegionSurface {
  /// Over the mesh's points. First faces that one tet alone has, which look outward, then faces
  /// between two regions.
  TriangleMesh mesh;
  std::size_t outerFaces = 0;
  double volume = 0; ///< of the tets
};

/// Faces are matched by point numbers. About 0.2 us a tet.
RegionSurface regionSurface(const TetMesh& mesh, Progress& progress);

} // namespace tetvdb
