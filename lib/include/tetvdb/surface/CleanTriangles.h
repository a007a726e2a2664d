// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>
#include <optional>

namespace tetvdb {

struct CleanOptions {
  /// World units: points nearer than this become one. 0: only points that are equal (-0 equals 0).
  /// None: equal points, and those of boundary edges that are one but for rounding, by a distance
  /// that follows from the mesh (WeldBoundary.h).
  std::optional<double> weldDistance;
  bool duplicates = true; ///< false: faces over the same three points all stay
  bool orient = true;     ///< false: every face keeps its side
};

/// What cleanTriangles() did.
struct CleanCounts {
  std::size_t weldedPoints = 0;       ///< points that became one with another
  std::size_t unreferencedPoints = 0; ///< points that no face used, dropped
  std::size_t degenerateFaces = 0;    ///< faces with a repeated point, dropped
  std::size_t duplicateFaces = 0;     ///< dropped
  std::size_t innerFaces = 0;         ///< walls within the solid that others close, dropped
  std::size_t flippedFaces = 0;       ///< reversed, whole shells included
  std::size_t flippedParts = 0;       ///< shells turned as a whole
  bool insideOut = false;             ///< the whole mesh was inside out and was turned
  /// World units: as asked for, or the largest between two points that became one.
  double weldDistance = 0;
  /// Neither the file's sides nor others give a winding field near whole numbers without losing
  /// what the other has: the volumes by sample points, of the file's own and of the others.
  bool doubtful = false;
  double fileVolume = 0, turnedVolume = 0;
};

/// Makes a soup into a mesh whose winding number means something:
/// - welds points, drops points without faces and faces with a repeated point. (Faces whose
///   three different points are collinear stay: they have no area, but neighbours' edges need
///   them.)
/// - of faces over the same three points keeps the number, one or none, that closes the edges
///   around: one of a model that is doubled throughout, none of a wall between two boxes.
/// - turns faces so that neighbours agree across edges that two faces share; a patch that cannot
///   agree (a Moebius strip) is left. What is already consistent keeps its side.
/// - turns patches that meet at edges of more faces, where these do not balance, the way that rays
///   to the outside say.
/// - turns shells that are inside out, with all that is nested in them. A shell within another that
///   looks inward stays a cavity, one that looks outward stays filled. A shell is what is connected
///   across shared edges, apart from what is balanced by itself and only touches the rest (two
///   boxes with an edge in common); an open one has a side only where it surrounds some volume.
/// - drops open patches within the solid, and turns patches where the winding field comes nearer to
///   a solid's by it.
/// Where edges have other than two faces, or duplicates went, the result is judged by winding
/// numbers at sample points: where the file's own are near whole numbers and not negative no face
/// is turned, and where what was solid is lost without the field coming nearer to whole numbers the
/// file's own faces stay. Where neither is sure CleanCounts::doubtful is set.
/// docs/algorithms.md has the rules. The order of the faces that stay, and of the points, is kept,
/// and each face's first corner. Deterministic, and the solid does not depend on the order of
/// points and faces. About 0.2 us a face for a mesh that is closed and consistent, 1 us for others;
/// judging takes up to 0.1 s.
CleanCounts cleanTriangles(TriangleMesh& mesh, const CleanOptions& options, Progress& progress);

} // namespace tetvdb
