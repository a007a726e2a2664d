// SPDX-License-Identifier: Apache-2.0
//
// Patches (faces connected across edges of exactly two faces) and components (faces connected
// across any shared edge) of a mesh.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/surface/EdgeTable.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

struct FacePatches {
  std::vector<std::uint32_t> patchOf; ///< by face; EdgeTable::kNone: left out of the table
  /// By face: 1 if its orientation is opposite to that of the first face of its patch.
  std::vector<std::uint8_t> against;
  /// By patch: 0 if it is not orientable (a Moebius strip); `against` is undefined then.
  std::vector<std::uint8_t> orientable;
  std::vector<std::uint32_t> partOf; ///< by patch: its component
  std::uint32_t partCount = 0;

  std::uint32_t patchCount() const { return static_cast<std::uint32_t>(partOf.size()); }
};

/// Patches and components are numbered in the order of their first faces. Parallel,
/// nearly linear, independent of the number of threads.
FacePatches findPatches(std::size_t faceCount, const EdgeTable& edges, Progress& progress);

/// Faces listed by patch or by group of patches.
struct FaceLists {
  std::vector<std::uint32_t> faces; ///< ascending within a list
  std::vector<std::uint32_t> first; ///< in faces; one more than there are lists

  std::size_t size(std::uint32_t list) const { return first[list + 1] - first[list]; }
  const std::uint32_t* begin(std::uint32_t list) const { return &faces[first[list]]; }
  const std::uint32_t* end(std::uint32_t list) const { return faces.data() + first[list + 1]; }
};

FaceLists listByPatch(const FacePatches& patches);
/// Lists faces by the value of `groupOf` (below `groupCount`) of their patch.
FaceLists listByGroup(const FacePatches& patches, const std::vector<std::uint32_t>& groupOf,
                      std::uint32_t groupCount);

} // namespace tetvdb
