// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/surface/EdgeTable.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Faces over the same three points, two or more a group; ascending within a group, groups by their
/// edges' order.
struct DuplicateGroups {
  std::vector<std::uint32_t> faces;
  std::vector<std::uint32_t> first; ///< in faces, one more than there are groups

  std::size_t count() const { return first.size() - 1; }
  /// Faces beyond the first of each group.
  std::size_t surplus() const { return faces.size() - count(); }
};

DuplicateGroups findDuplicates(const EdgeTable& edges);

/// What becomes of each face.
enum class FaceFate : std::uint8_t {
  Stays,
  Goes,
  StaysWithoutSide ///< as many of its copies look one way as the other
};

/// Decides so that of each group one face or none is left, whichever closes the edges around;
/// docs/algorithms.md has the rules. Of a group that keeps one, it is the first of the orientation
/// that most of its faces have.
std::vector<FaceFate> resolveDuplicates(const std::vector<std::uint32_t>& corners,
                                        std::size_t pointCount, const DuplicateGroups& groups,
                                        Progress& progress);

} // namespace tetvdb
