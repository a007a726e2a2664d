// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct SheetCounts {
  std::size_t parts = 0; ///< dropped
  std::size_t faces = 0; ///< of these
  bool complete = true;  ///< false: there are too many open parts to look at, and all stayed
};

/// Drops open parts that bound no volume: parts (connected across edges) with boundary edges whose
/// faces, for less than half of their area, have a winding number of the whole mesh above 0.6 on
/// their inner side and below 0.4 on the outer one. A sheet has at most a half on its inner side; a
/// box without a lid, or a ball with a hole, has more. Faces that lie within a solid of other parts
/// do not count. Points that no face uses any more are dropped. Looks at up to 64 faces a part.
SheetCounts dropSheets(TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
