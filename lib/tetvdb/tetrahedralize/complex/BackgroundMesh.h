// SPDX-License-Identifier: Apache-2.0
//
// The background mesh: tetrahedra over a box that have the soup's points among their corners, into
// which triangles are inserted.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Of points 0.., the tets over them, all positive by latticeOrientation(), filling a box.
/// neighbours[t][i] is the tet across the face opposite corner i, kNoTet on the box's sides.
struct PlainTets {
  static constexpr std::uint32_t kNoTet = 0xFFFFFFFFu;
  std::vector<std::array<std::uint32_t, 4>> tets;
  std::vector<std::array<std::uint32_t, 4>> neighbours;
};

/// Delaunay tetrahedra of distinct lattice points, multiples of `grain` that have 38 bits along
/// each axis, the first eight of which are the corners of a box (x fastest, then y, then z) that
/// holds all others strictly inside or on its sides. Incremental (Bowyer-Watson) along a
/// space-filling curve, with exact predicates: no point lies strictly inside a tet's sphere, and
/// every tet is positive, whatever points are coplanar or cospherical. Deterministic. 3 to 5 us a
/// point. Throws Error(Invalid) where a point is repeated, Error(Limit) beyond 2^30 tets.
PlainTets delaunayTets(const std::vector<Vec3d>& points, double grain, Progress& progress);

/// Points to mesh: the box's eight corners first, then the soup's points in their order, then
/// points in between, away from the surface: a body-centred lattice as dense as a cubic one of
/// `spacing`, slightly perturbed so that no five are cospherical, that fills the box and its sides
/// and leaves out what is nearer to the soup than `clearance`. The box is the soup's, grown by
/// `margin` on each side (at least a grain; what the working lattice has room for at most). All
/// points are distinct and multiples of the soup's grain. The spacing is enlarged where there would
/// be more than 200,000 of them. Parallel.
std::vector<Vec3d> backgroundPoints(const LatticeSoup& soup, double margin, double spacing,
                                    double clearance, Progress& progress);

} // namespace tetvdb
