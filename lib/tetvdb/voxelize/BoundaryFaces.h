// SPDX-License-Identifier: Apache-2.0
//
// The boundary of a tet mesh: the faces whose signs do not cancel when the faces of all tets are
// added up.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// A triangle whose normal (of a, b, c in this order) points out of the mesh.
struct BoundaryFace {
  std::uint32_t a, b, c;
  std::int32_t weight; ///< > 0; above 1 where overlapping tets share the face with one orientation
};

struct Boundary {
  std::vector<BoundaryFace> faces;
  std::uint64_t flipped = 0; ///< tets of negative orientation, counted as reversed
  std::uint64_t dropped = 0; ///< flat tets, left out
};

/// Sums the signs of equal faces (equal by vertex index) over all tets, each turned to positive
/// orientation, and keeps the faces whose sum is not zero. As a chain this is the boundary of the
/// sum of the tets, so the signed crossings of a ray count the tets around a point, overlaps
/// included. (Counting the faces that belong to one tet alone would be wrong there.)
///
/// Faces are matched only around open vertices: those where the signed sum of random numbers, one a
/// face around the vertex, does not vanish. An open vertex is taken for closed with a probability
/// below 2^-58. The faces found then do not close; this is checked with the same sums, and if it
/// fails, all faces are matched (docs/algorithms.md). Parallel. Costs about 8 ns a tet on one
/// core, 8 bytes a point and thread, and 30 ns and 28 bytes for each face around an open vertex.
/// The order of the faces depends only on the mesh. Throws Error(Limit) for 2^31 points or more and
/// for tets longer than kMaxTetExtent.
Boundary boundaryFaces(const SnappedMesh& mesh, Progress& progress);
/// The same of points in world space, as if they were snapped by `transform`; they must lie in
/// 32-bit index space. Saves the memory and the time for all of them.
Boundary boundaryFaces(const TetMesh& mesh, const GridTransform& transform, Progress& progress);

/// Numbers the points of the faces anew, in the order that they have; returns their old numbers.
std::vector<std::uint32_t> renumberPoints(std::vector<BoundaryFace>& faces, std::size_t pointCount);

/// Snaps the points that the faces use, which are numbered anew.
SnappedMesh snapUsed(const std::vector<Vec3d>& points, Boundary& boundary,
                     const GridTransform& transform, Progress& progress);

} // namespace tetvdb
