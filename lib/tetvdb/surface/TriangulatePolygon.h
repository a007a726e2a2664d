// SPDX-License-Identifier: Apache-2.0
//
// Triangulates a plane polygon with or without holes.
//
//   std::vector<std::uint32_t> corners;
//   if (!tetvdb::triangulatePolygon(points, {outer, hole}, normal, notTaken, corners))
//     ...; // it intersects itself, or has no area
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace tetvdb {

/// Whether an edge between two points already exists and must not become an inner edge.
using EdgeTaken = std::function<bool(std::uint32_t, std::uint32_t)>;

/// A directed edge of a boundary: the points from and to.
using PolygonEdge = std::pair<std::uint32_t, std::uint32_t>;

/// What becomes of edges that wind around a place more than once, or in the wrong direction.
enum class Overlaps {
  Refused,
  Merged ///< triangles are where the winding number of the edges is above 0, each once
};

/// Appends to `corners`, three point numbers per triangle, triangles over exactly the points of
/// `edges` and the `inner` points, which lie inside; none is collinear in the projection along
/// the normal's largest axis. The edges, in any order, bound one or several regions to the left
/// of each edge, seen from where `normal` points to. Regions may have holes and may touch
/// themselves or one another at points. The points lie nearly in one plane. The triangulation of
/// all points is constrained to the edges and decided by exact orientation
/// (geometry/Orientation.h). Inner edges are then flipped if they are taken or if the smallest
/// angle grows. A taken edge that no flip removes stays. Returns false, and appends nothing, if
/// there is no such triangulation: edges that cross one another or pass through points, points
/// that coincide in the projection, regions without a closed boundary, regions that overlap unless
/// they are merged, no region at all. An edge that is given several times counts as often. About
/// O(n^1.5) for n points, 2 us each.
bool triangulateEdges(const std::vector<Vec3d>& points, const std::vector<PolygonEdge>& edges,
                      const std::vector<std::uint32_t>& inner, const Vec3d& normal,
                      const EdgeTaken& isTaken, Overlaps overlaps,
                      std::vector<std::uint32_t>& corners);

/// The same for loops: the first loop is the outline, counter-clockwise around `normal`; the others
/// are holes in it, clockwise.
bool triangulatePolygon(const std::vector<Vec3d>& points,
                        const std::vector<std::vector<std::uint32_t>>& loops, const Vec3d& normal,
                        const EdgeTaken& isTaken, std::vector<std::uint32_t>& corners);

} // namespace tetvdb
