// SPDX-License-Identifier: Apache-2.0
//
// Which faces of a soup go and which are turned: the part of cleanTriangles() that follows once
// points are welded. docs/algorithms.md has the rules.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/CleanTriangles.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

struct FaceDecision {
  std::vector<std::uint8_t> dropped; ///< by face; empty: none is
  std::vector<std::uint8_t> turned;  ///< by face; empty: none is
  std::size_t innerFaces = 0;        ///< of those dropped, the ones within the solid
  std::size_t turnedShells = 0;
  bool insideOut = false;
  bool doubtful = false;                   ///< see CleanCounts
  double fileVolume = 0, turnedVolume = 0; ///< where it is doubtful: estimates by sample points
};

/// `mesh` is welded, without faces with a repeated point, and in canonical order
/// (CanonicalOrder.h).
FaceDecision decideFaces(const TriangleMesh& mesh, const CleanOptions& options, Progress& progress);

} // namespace tetvdb
