// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct CleanOptions {
  /// World units: points nearer than this become one. 0: only points that are equal (-0 equals 0).
  double weldDistance = 0;
  bool duplicates = true; ///< false: faces over the same three points all stay
  bool orient = true;     ///< false: every face keeps its side
};

/// What cleanTriangles() did.
struct CleanCounts {
  std::size_t weldedPoints = 0;       ///< points that became one with another
  std::size_t unreferencedPoints = 0; ///< points that no face used, dropped
  std::size_t degenerateFaces = 0;    ///< faces with a repeated point, dropped
  std::size_t duplicateFaces = 0;     ///< dropped
  std::size_t flippedFaces = 0;       ///< turned round, parts that were turned as a whole included
  std::size_t flippedParts = 0;       ///< connected parts turned as a whole
  bool insideOut = false;             ///< the whole mesh was inside out and was turned
};

/// Makes a soup into a mesh whose winding number means something:
/// - welds equal points, drops points without faces and faces with a repeated point. (Faces whose
///   three different points are collinear stay: they have no area, but neighbours' edges need
///   them.)
/// - of faces over the same three points keeps the number, one or none, that closes the edges
///   around: one of a model that is doubled throughout, none of a wall between two boxes.
/// - turns faces so that neighbours agree across edges that two faces share; a patch that cannot
///   agree (a Moebius strip) is left. What is already consistent keeps its side.
/// - turns connected parts that are inside out. A part inside another that looks inward stays a
///   cavity, one that looks outward stays filled; docs/algorithms.md has the rules.
/// The order of the faces that stay, and of the points, is kept. Deterministic. About 0.5 us a
/// face.
CleanCounts cleanTriangles(TriangleMesh& mesh, const CleanOptions& options, Progress& progress);

} // namespace tetvdb
