// SPDX-License-Identifier: Apache-2.0
//
// Finds points that differ only by rounding, within a distance that is computed from the mesh.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/EdgeTable.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

struct BoundaryWeld {
  /// By point, the point that replaces it; empty if nothing is to be welded.
  std::vector<std::uint32_t> becomes;
  double distance = 0; ///< world units: the largest distance between two merged points
};

enum class WeldCandidates {
  BoundaryPoints, ///< points of edges of one face
  AllPoints
};

/// Merges points that are closer than all of
/// - a quarter of the shortest edge at either point (so that no edge collapses and no detail of the
///   mesh is lost),
/// - 1e-4 of the mesh's size, or 2e-6 of its largest coordinate if that is more (the error of
///   single precision and of six digits),
/// - four times the 90 % quantile of the candidates' distances to the nearest other candidate. The
///   result is accepted only as a whole: if it closes at least half of the boundary edges and at
///   least one per removed point, since rounding affects all of a file (with AllPoints: if at least
///   half of the faces become duplicates). `mesh` must not have equal points. Of merged points,
///   that of the largest component (by faces, connected across points) keeps its position, so that
///   smaller components are adapted to it. The merged points and their positions do not depend on
///   the order of points.
BoundaryWeld weldBoundary(const TriangleMesh& mesh, const EdgeTable& edges,
                          WeldCandidates candidates, Progress& progress);

} // namespace tetvdb
