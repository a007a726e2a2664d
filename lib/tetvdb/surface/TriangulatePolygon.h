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
#include <vector>

namespace tetvdb {

/// Whether an edge between two points exists already and must not become an inner edge.
using EdgeTaken = std::function<bool(std::uint32_t, std::uint32_t)>;

/// Appends to `corners`, three point numbers each, triangles over exactly the points of `loops`,
/// none of them collinear as seen along the normal's largest axis. The first loop is the outline
/// and turns counter-clockwise around `normal`, the others are holes in it and turn clockwise;
/// points are as good as in one plane. Ears are clipped, the best shaped one first, decided by
/// exact orientation (geometry/Orientation.h); inner edges are then flipped where that makes the
/// smallest angle larger. Edges that are taken are used only where there is no other way. Returns
/// false, and appends nothing, where no such triangles are found: loops that cross. O(n^2) for n
/// points.
bool triangulatePolygon(const std::vector<Vec3d>& points,
                        const std::vector<std::vector<std::uint32_t>>& loops, const Vec3d& normal,
                        const EdgeTaken& isTaken, std::vector<std::uint32_t>& corners);

} // namespace tetvdb
