// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace tetvdb {

/// What became of the faces, coincident ones counted as one.
struct TrimCounts {
  std::size_t met = 0;     ///< that others cross, touch or overlap
  std::size_t removed = 0; ///< with no part on the boundary
  std::size_t cut = 0;     ///< with a part on the boundary
  std::size_t pieces = 0;  ///< convex pieces that are left of these
};

} // namespace tetvdb
