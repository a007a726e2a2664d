// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/surface/EdgeTable.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Groups of two or more faces with the same three points, ascending within a group. Groups are in
/// the order of their edges.
struct DuplicateGroups {
  std::vector<std::uint32_t> faces;
  std::vector<std::uint32_t> first; ///< in faces; one more than there are groups

  std::size_t count() const { return first.size() - 1; }
  /// Number of faces beyond the first of each group.
  std::size_t surplus() const { return faces.size() - count(); }
};

DuplicateGroups findDuplicates(const EdgeTable& edges);

/// The decision about a face.
enum class FaceFate : std::uint8_t {
  Stays,
  Goes,
  StaysWithoutSide ///< its copies have both orientations equally often
};

/// Keeps one face or none of each group, whichever closes the surrounding edges; docs/algorithms.md
/// has the rules. The face that is kept is the first of the orientation that most faces of the
/// group have.
std::vector<FaceFate> resolveDuplicates(const std::vector<std::uint32_t>& corners,
                                        std::size_t pointCount, const DuplicateGroups& groups,
                                        Progress& progress);

} // namespace tetvdb
