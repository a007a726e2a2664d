// SPDX-License-Identifier: Apache-2.0
//
// Tests whether a new face would intersect the existing faces of a mesh that changes.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/BoxTree.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Exact (geometry/FaceContact.h). Requires distinct points. Not thread-safe: queries write marks.
class CrossingGuard {
public:
  using Corners = std::array<std::uint32_t, 3>;

  /// `points` must outlive the guard. A point may change while no face uses it, and if change() is
  /// called for all its faces before the next query that does not replace them.
  CrossingGuard(const std::vector<Vec3d>& points, std::vector<Corners> faces);

  /// The number of pairs of one of the `added` faces and another of them, or an existing face that
  /// is not in `replaced`, that meet in more than their common points or edge. A collinear face
  /// counts as one pair, and meets no other. Stops counting at `most`. About 1 us per face.
  std::size_t crossings(const std::vector<Corners>& added,
                        const std::vector<std::uint32_t>& replaced, std::size_t most);

  /// Whether there are any.
  bool crosses(const std::vector<Corners>& added, const std::vector<std::uint32_t>& replaced) {
    return crossings(added, replaced, 1) > 0;
  }

  const Corners& corners(std::uint32_t face) const { return faces_[face]; }

  /// Replaces the corners of a face.
  void change(std::uint32_t face, const Corners& corners);
  void remove(std::uint32_t face);

private:
  Box boxOf(const Corners& corners) const;
  bool isFlat(const Corners& corners) const;
  void build();

  const std::vector<Vec3d>& points_;
  std::vector<Corners> faces_;
  std::vector<char> isGone_, isFlat_;
  std::vector<std::uint32_t> mark_; ///< by face: the last query that replaced it
  std::uint32_t query_ = 0;
  std::vector<std::uint32_t> items_;  ///< faces, by item of the tree
  std::vector<std::uint32_t> itemOf_; ///< by face
  std::size_t live_ = 0;
  BoxTree tree_;
};

} // namespace tetvdb
