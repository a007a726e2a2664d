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

struct OpenComponents {
  std::size_t count = 0;  ///< components with boundary edges
  std::size_t sheets = 0; ///< of them, those that bound no volume, and are not within a solid
  bool exact = true;      ///< false: `sheets` is estimated from some of them
};

/// Counts open components, and looks at up to 64 of them, evenly by their areas' order, for whether
/// they are sheets, as dropSheets() does; a mesh of one component is not looked at. Costs about 0.2
/// us per face and up to 0.2 s. With more than about 300,000 boundary edges, `sheets` is 0 and not
/// exact. Deterministic.
OpenComponents countSheets(const TriangleMesh& mesh, Progress& progress);

/// Removes open components that bound no volume. A component (faces connected across edges) with
/// boundary edges is removed if, on less than half of its area, the winding number of the whole
/// mesh is above 0.6 on the inner side. On a sheet it is at most 0.5 there; on a box without a lid
/// or a ball with a hole it is larger. Faces inside the solid of other components are not counted.
/// Points that no face uses any more are removed. Tests up to 64 faces per component.
SheetCounts dropSheets(TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
