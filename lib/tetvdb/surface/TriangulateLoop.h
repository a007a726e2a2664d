// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/surface/TriangulatePolygon.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace tetvdb {

/// A closed loop of points in space, and for each edge (from point i to point i + 1) the third
/// corner of the adjacent face.
struct SpaceLoop {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> points;
  std::vector<std::uint32_t> beyond; ///< kNone: there is no adjacent face
};

/// Appends to `corners` n - 2 triangles over a loop of n points, with small dihedral angles and a
/// small area: for every section of the loop, the triangulation with the smallest maximum angle
/// between adjacent normals, including the faces adjacent to the loop, and among equal ones the
/// smallest area (G. Barequet and M. Sharir, Filling gaps in the boundary of a polyhedron, 1995; P.
/// Liepa, Filling holes in meshes, 2003). Loops of more than kMaxLoopPoints are first cut along
/// short chords. Edges for which `isTaken` holds are avoided. Triangles have the loop's direction.
/// Returns false, and appends nothing, if every triangulation uses a taken edge. O(n^3), 0.1 us per
/// step.
bool triangulateLoop(const std::vector<Vec3d>& points, const SpaceLoop& loop,
                     const EdgeTaken& isTaken, std::vector<std::uint32_t>& corners,
                     Progress& progress);

constexpr std::size_t kMaxLoopPoints = 200;

} // namespace tetvdb
