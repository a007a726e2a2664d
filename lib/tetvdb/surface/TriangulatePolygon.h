// SPDX-License-Identifier: Apache-2.0
//
// Triangles that fill a plane polygon, with holes or without.
//
//   std::vector<std::uint32_t> corners;
//   if (!tetvdb::triangulatePolygon(points, {outer, hole}, normal, notTaken, corners))
//     ...; // it crosses itself, or has no area
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace tetvdb {

/// Whether an edge between two points exists already and must not become an inner edge.
using EdgeTaken = std::function<bool(std::uint32_t, std::uint32_t)>;

/// A directed edge of a boundary: the points it runs from and to.
using PolygonEdge = std::pair<std::uint32_t, std::uint32_t>;

/// Appends to `corners`, three point numbers each, triangles over exactly the points of `edges` and
/// the `inner` ones, which lie within, none of them collinear as seen along the normal's largest
/// axis. The edges, in any order, bound
/// one or several regions that lie to the left of each edge as seen from where `normal` points to;
/// regions may have holes and may touch themselves or one another at points. Points are as good as
/// in one plane. A triangulation of all points is constrained to the edges, decided by exact
/// orientation (geometry/Orientation.h); inner edges are then flipped away where they are taken,
/// and where that makes the smallest angle larger. A taken edge that no flip removes stays. Returns
/// false, and appends nothing, where there are no such triangles: edges that cross one another or
/// pass through points, points that are equal as seen, regions without a closed boundary. About
/// O(n^1.5) for n points, 2 us each.
bool triangulateEdges(const std::vector<Vec3d>& points, const std::vector<PolygonEdge>& edges,
                      const std::vector<std::uint32_t>& inner, const Vec3d& normal,
                      const EdgeTaken& isTaken, std::vector<std::uint32_t>& corners);

/// The same for loops: the first loop is the outline and turns counter-clockwise around `normal`,
/// the others are holes in it and turn clockwise.
bool triangulatePolygon(const std::vector<Vec3d>& points,
                        const std::vector<std::vector<std::uint32_t>>& loops, const Vec3d& normal,
                        const EdgeTaken& isTaken, std::vector<std::uint32_t>& corners);

} // namespace tetvdb
