// SPDX-License-Identifier: Apache-2.0
//
// Decides which faces of a soup are removed and which are reversed: the second stage of
// cleanTriangles(), after welding. docs/algorithms.md has the rules.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/CleanTriangles.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

struct FaceDecision {
  std::vector<std::uint8_t> dropped; ///< by face; empty: none
  std::vector<std::uint8_t> turned;  ///< by face; empty: none
  std::size_t innerFaces = 0;        ///< number of dropped faces inside the solid
  std::size_t turnedShells = 0;
  bool insideOut = false;
  bool doubtful = false;                   ///< see CleanCounts
  double fileVolume = 0, turnedVolume = 0; ///< estimated by sample points, if doubtful
};

/// Requires a welded mesh without repeated points in faces, in canonical order
/// (CanonicalOrder.h).
FaceDecision decideFaces(const TriangleMesh& mesh, const CleanOptions& options, Progress& progress);

} // namespace tetvdb
