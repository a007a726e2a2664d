// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct SheetCounts {
  std::size_t parts = 0; ///< removed components
  std::size_t faces = 0; ///< their faces
  bool complete = true;  ///< false: too many open components to test; none was removed
};

/// Removes open components that bound no volume. A component (faces connected across edges) with
/// boundary edges is removed if, on less than half of its area, the winding number of the whole
/// mesh is above 0.6 on the inner side. On a sheet it is at most 0.5 there; on a box without a lid
/// or a ball with a hole it is larger. Faces inside the solid of other components are not counted.
/// Points that no face uses any more are removed. Tests up to 64 faces per component.
SheetCounts dropSheets(TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
