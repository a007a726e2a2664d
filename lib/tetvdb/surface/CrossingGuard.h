// SPDX-License-Identifier: Apache-2.0
//
// Faces that change, and whether a new one would cross those that are there.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/BoxTree.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Exact (geometry/FaceContact.h). Equal points have one number, no face is collinear. Not
/// thread-safe: crosses() keeps marks.
class CrossingGuard {
public:
  using Corners = std::array<std::uint32_t, 3>;

  /// `points` must outlive the guard and stay as they are while faces use them.
  CrossingGuard(const std::vector<Vec3d>& points, std::vector<Corners> faces);

  /// Whether any of the `added` faces meets another of them, or a face that is there and not among
  /// `replaced`, in more than the points or the edge that they have in common. About 1 us a face.
  bool crosses(const std::vector<Corners>& added, const std::vector<std::uint32_t>& replaced);

  /// Gives a face other corners.
  void change(std::uint32_t face, const Corners& corners);
  void remove(std::uint32_t face);

private:
  Box boxOf(const Corners& corners) const;
  void build();

  const std::vector<Vec3d>& points_;
  std::vector<Corners> faces_;
  std::vector<char> isGone_;
  std::vector<std::uint32_t> mark_; ///< of a face: the last call of crosses() that replaced it
  std::uint32_t call_ = 0;
  std::vector<std::uint32_t> items_;  ///< of the tree: faces
  std::vector<std::uint32_t> itemOf_; ///< of a face
  std::size_t live_ = 0;
  BoxTree tree_;
};

} // namespace tetvdb
