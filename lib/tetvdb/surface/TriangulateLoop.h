// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/surface/TriangulatePolygon.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace tetvdb {

/// A closed loop of points in space, and of each of its edges (from point i to point i + 1) the
/// third corner of the face beyond it.
struct SpaceLoop {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> points;
  std::vector<std::uint32_t> beyond; ///< kNone: nothing is known of it
};

/// Appends to `corners` the n - 2 triangles over the points of a loop of n that bend little and
/// have a small area: of every part of the loop those whose largest angle between neighbours'
/// normals, faces beyond the loop included, is least, and of equal ones those of least area (G.
/// Barequet and M. Sharir, Filling gaps in the boundary of a polyhedron, 1995; P. Liepa, Filling
/// holes in meshes, 2003). Loops of more than kMaxLoopPoints are cut along short chords into such.
/// Edges that are taken are avoided. Every triangle runs along the loop in its direction. Returns
/// false, and appends nothing, where all ways use edges that are taken. O(n^3), 0.1 us each.
bool triangulateLoop(const std::vector<Vec3d>& points, const SpaceLoop& loop,
                     const EdgeTaken& isTaken, std::vector<std::uint32_t>& corners,
                     Progress& progress);

constexpr std::size_t kMaxLoopPoints = 200;

} // namespace tetvdb
