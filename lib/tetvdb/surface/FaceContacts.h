// SPDX-License-Identifier: Apache-2.0
//
// Which faces meet in more than an edge or a corner that they share.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/BoxBlocks.h"
#include "tetvdb/surface/WeldedFaces.h"

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tetvdb {

struct FaceContacts {
  /// Faces met by face i: others[starts[i]] to others[starts[i + 1] - 1].
  std::vector<std::size_t> starts;
  std::vector<std::uint32_t> others;
  /// Pairs of faces on either side of an edge that no third face has; neither is met by any other.
  /// In no order.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> neighbours;
  bool complete = true; ///< false: there are too many to look at, and the rest is empty
  bool equal = false;   ///< some are over the same three points, and the rest is empty

  bool isMet(std::size_t face) const { return starts[face] != starts[face + 1]; }
};

/// `boxes` are the faces' boxes. Exact. Parallel, about 0.3 us a face; gives up where boxes of more
/// than 2^25 pairs of faces, and 64 for every face, meet. The same, but for the order of
/// neighbours, for any number of threads.
FaceContacts findContacts(const WeldedFaces& welded, const BoxBlocks& boxes, Progress& progress);

} // namespace tetvdb
