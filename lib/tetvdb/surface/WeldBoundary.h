// SPDX-License-Identifier: Apache-2.0
//
// Which points of a mesh are one but for rounding, by a distance that follows from the mesh.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/EdgeTable.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

struct BoundaryWeld {
  /// By point the one that it becomes; empty where nothing is to be welded.
  std::vector<std::uint32_t> becomes;
  double distance = 0; ///< world units: the largest between two points that become one
};

enum class WeldCandidates {
  BoundaryPoints, ///< ends of edges of one face
  AllPoints
};

/// Points become one that are nearer to one another than
/// - a quarter of the shortest edge at either (no edge collapses, and nothing finer than the mesh
///   itself is merged),
/// - 1e-4 of the mesh's size, or 2e-6 of its largest coordinate where that is more (what single
///   precision and six digits leave),
/// - four times the distance to the nearest such point that nine of ten candidates have.
/// The result is accepted as a whole, where it closes half of the boundary edges or more, and at
/// least one for each point that goes: points that differ by rounding do so all over a file (of all
/// points: where it makes at least half of the faces duplicates of others). `mesh` is without equal
/// points. Of points that become one that of the largest component (of most faces, connected across
/// points) stays: components that are welded to it change, it does not. Which points become one,
/// and where, does not depend on their order.
BoundaryWeld weldBoundary(const TriangleMesh& mesh, const EdgeTable& edges,
                          WeldCandidates candidates, Progress& progress);

} // namespace tetvdb
