// SPDX-License-Identifier: Apache-2.0
//
// Finds the faces that meet in more than a shared edge or corner.
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
  /// The faces that face i meets: others[starts[i]] to others[starts[i + 1] - 1].
  std::vector<std::size_t> starts;
  std::vector<std::uint32_t> others;
  /// Pairs of faces at an edge of exactly these two faces; neither meets any other face. In several
  /// vectors, unordered.
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> neighbours;
  bool complete = true; ///< false: there are too many candidates, and all else is empty
  bool equal = false;   ///< some faces have the same three points, and all else is empty

  bool isMet(std::size_t face) const { return starts[face] != starts[face + 1]; }
};

/// `boxes` are those of the faces. Exact. Parallel, about 0.3 us per face. Fails if the boxes of
/// more than 2^25 pairs of faces, and of 64 pairs per face, overlap. Independent of the number of
/// threads, except for the order of `neighbours`.
FaceContacts findContacts(const WeldedFaces& welded, const BoxBlocks& boxes, Progress& progress);

} // namespace tetvdb
