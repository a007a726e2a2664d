// SPDX-License-Identifier: Apache-2.0
//
// The faces of tets in an order in which equal faces are adjacent.
//
//   const auto faces = tetvdb::sortedTetFaces(mesh.tets.data(), mesh.tetCount(), keep, progress);
//   tetvdb::forEqualFaces(faces, [&](const TetFace* first, const TetFace* last) { ... });
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/core/LargeVector.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/TetFaces.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <vector>

namespace tetvdb {

struct TetFace {
  std::array<std::uint32_t, 3> corners; ///< points, ascending
  std::uint32_t tet : 30, opposite : 2; ///< opposite: the corner of the tet that is not on the face

  /// By corners, then tet, then opposite corner.
  bool operator<(const TetFace& other) const {
    if (corners != other.corners)
      return corners < other.corners;
    return tet != other.tet ? tet < other.tet : opposite < other.opposite;
  }
};

/// Returns the faces of tets (four points each) for which keep(face) holds, sorted; several threads
/// call keep(). Parallel; 16 bytes per face. Throws Error(Limit) for 2^30 tets or more.
template <typename Keep>
LargeVector<TetFace> sortedTetFaces(const std::uint32_t* tets, std::size_t tetCount,
                                    const Keep& keep, Progress& progress) {
  if (tetCount >= std::size_t(1) << 30)
    throw Error(Status::Limit, "", "more than 2^30 tetrahedra", "extract their surface in parts");
  constexpr std::size_t kTetsPerTask = 1 << 14;
  const std::size_t tasks = (tetCount + kTetsPerTask - 1) / kTetsPerTask;
  const auto eachTask = [&](const auto& found) { // found(task, face)
    tbb::parallel_for(std::size_t(0), tasks, [&](std::size_t task) {
      progress.check();
      const std::size_t end = std::min(tetCount, (task + 1) * kTetsPerTask);
      for (std::size_t tet = task * kTetsPerTask; tet < end; ++tet)
        for (std::uint32_t opposite = 0; opposite < 4; ++opposite) {
          TetFace face{{}, static_cast<std::uint32_t>(tet) & 0x3FFFFFFFu, opposite & 3u};
          for (std::size_t k = 0; k < 3; ++k)
            face.corners[k] = tets[4 * tet + kFaceCorners[opposite][k]];
          std::sort(face.corners.begin(), face.corners.end());
          if (keep(face))
            found(task, face);
        }
    });
  };
  std::vector<std::size_t> next(tasks + 1, 0); // counts, then the position of a task's next face
  eachTask([&](std::size_t task, const TetFace&) { ++next[task + 1]; });
  for (std::size_t task = 0; task < tasks; ++task)
    next[task + 1] += next[task];
  LargeVector<TetFace> faces(next[tasks]);
  eachTask([&](std::size_t task, const TetFace& face) { faces[next[task]++] = face; });
  tbb::parallel_sort(faces.begin(), faces.end());
  progress.check();
  return faces;
}

/// Calls visit(first, last) for the faces first <= f < last with the same corners, in order.
template <typename Visit>
void forEqualFaces(const LargeVector<TetFace>& faces, const Visit& visit) {
  const TetFace* const end = faces.data() + faces.size();
  for (const TetFace* first = faces.data(); first != end;) {
    const TetFace* last = first + 1;
    while (last != end && last->corners == first->corners)
      ++last;
    visit(first, last);
    first = last;
  }
}

} // namespace tetvdb
