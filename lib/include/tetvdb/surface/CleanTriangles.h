// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/DropSheets.h"

#include <cstddef>
#include <optional>

namespace tetvdb {

struct CleanOptions {
  /// World units. Points closer than this are merged. 0 merges equal points only (-0 equals 0).
  /// Without a value, equal points are merged, and boundary points that differ only by rounding,
  /// within a distance that is computed from the mesh (WeldBoundary.h).
  std::optional<double> weldDistance;
  bool duplicates = true;  ///< false: keeps all faces with the same three points
  bool orient = true;      ///< false: keeps the orientation of every face
  bool closeHoles = false; ///< true: closes components that bound a volume last (CloseComponents.h)
};

/// What cleanTriangles() did.
struct CleanCounts {
  std::size_t weldedPoints = 0;       ///< points that were merged into another point
  std::size_t unreferencedPoints = 0; ///< removed points that no face uses
  std::size_t degenerateFaces = 0;    ///< removed faces with a repeated point
  std::size_t duplicateFaces = 0;     ///< removed duplicates
  std::size_t innerFaces = 0;         ///< removed walls inside the solid
  std::size_t flippedFaces = 0;       ///< reversed faces, including those of whole shells
  std::size_t flippedParts = 0;       ///< shells that were reversed as a whole
  std::size_t closedHoles = 0;        ///< holes of components that were closed
  std::size_t closingFaces = 0;       ///< appended faces that close them
  OpenComponents open;                ///< with CleanOptions::closeHoles: what stays open
  bool insideOut = false;             ///< the whole mesh was inside out and was reversed
  /// World units: the requested distance, or the largest distance between two merged points.
  double weldDistance = 0;
  /// Neither the orientation of the input nor the new one is close to a solid's without losing
  /// volume of the other. The volumes of both, estimated by sample points, follow.
  bool doubtful = false;
  double fileVolume = 0, turnedVolume = 0;
};

/// Converts a triangle soup into a mesh whose winding number defines a solid:
/// - Merges points. Removes unused points and faces with a repeated point. Collinear faces with
///   three different points stay: they have no area, but the edges of their neighbours need them.
/// - Of several faces with the same three points, keeps the number, one or none, that closes the
///   surrounding edges: one if the whole model is duplicated, none for a wall between two boxes.
/// - Reverses faces so that the two faces of an edge have consistent orientations. A patch that is
///   not orientable (a Moebius strip) is not changed, and neither are faces that are consistent.
/// - Reverses patches that meet at edges of three or more faces if the orientations there do not
///   balance. Rays to the outside determine the orientation.
/// - Reverses shells that are inside out, with all shells nested in them. An inward-oriented shell
///   within another shell stays a cavity, an outward-oriented one stays filled. A shell is a set of
///   faces that are connected across shared edges; a set that is balanced by itself and only
///   touches others is a shell of its own (two boxes with a common edge). An open shell has an
///   inside only if it encloses some volume.
/// - Removes open patches inside the solid. Reverses patches if this brings the winding numbers
///   closer to those of a solid.
/// If edges have other than two faces, or if duplicates were removed, the result is checked by
/// winding numbers at sample points. If those of the input are near whole numbers and not negative,
/// no face is reversed. If volume is lost and the winding numbers are no closer to whole numbers,
/// the faces of the input are kept. If neither is certain, CleanCounts::doubtful is set.
/// docs/algorithms.md has the rules. The order of the remaining faces and points and the first
/// corner of each face do not change. Deterministic; the solid does not depend on the order of
/// points and faces. Costs about 0.2 us per face of a closed, consistent mesh, 1 us per face of
/// others, and up to 0.1 s for the check. Throws Error(Usage) for a negative weld distance.
CleanCounts cleanTriangles(TriangleMesh& mesh, const CleanOptions& options, Progress& progress);

} // namespace tetvdb
