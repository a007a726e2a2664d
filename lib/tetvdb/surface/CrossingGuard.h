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

/// Exact (geometry/FaceContact.h). Requires distinct points and no collinear face. Not thread-safe:
/// crosses() writes marks.
class CrossingGuard {
public:
  using Corners = std::array<std::uint32_t, 3>;

  /// `points` must outlive the guard and must not change while faces use them.
  CrossingGuard(const std::vector<Vec3d>& points, std::vector<Corners> faces);

  /// Returns whether one of the `added` faces meets another of them, or an existing face that is
  /// not in `replaced`, in more than their common points or edge. About 1 us per face.
  bool crosses(const std::vector<Corners>& added, const std::vector<std::uint32_t>& replaced);

  /// Replaces the corners of a face.
  void change(std::uint32_t face, const Corners& corners);
  void remove(std::uint32_t face);

private:
  Box boxOf(const Corners& corners) const;
  void build();

  const std::vector<Vec3d>& points_;
  std::vector<Corners> faces_;
  std::vector<char> isGone_;
  std::vector<std::uint32_t> mark_; ///< by face: the last call of crosses() that replaced it
  std::uint32_t call_ = 0;
  std::vector<std::uint32_t> items_;  ///< faces, by item of the tree
  std::vector<std::uint32_t> itemOf_; ///< by face
  std::size_t live_ = 0;
  BoxTree tree_;
};

} // namespace tetvdb
