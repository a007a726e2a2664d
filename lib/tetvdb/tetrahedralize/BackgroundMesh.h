// SPDX-License-Identifier: Apache-2.0
//
// Tetrahedra over a box that have the soup's points among their corners: what triangles are then
// inserted into.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/tetrahedralize/LatticeSoup.h"

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

/// Delaunay tetrahedra of distinct lattice points, the first eight of which are the corners of a
/// box (x fastest, then y, then z) that holds all others strictly inside or on its sides.
/// Incremental (Bowyer-Watson) along a space-filling curve. Spheres are judged in rounded
/// arithmetic, and a cavity is made star-shaped by exact orientations: where five points are
/// cospherical to rounding the tets may not be Delaunay, but they are always valid. Deterministic.
/// About 5 us a point.
PlainTets delaunayTets(const std::vector<Vec3d>& points, Progress& progress);

/// Points to mesh: the box's eight corners first, then the soup's points in their order, then
/// points in between, away from the surface: a lattice of about `spacing`, slightly shaken so that
/// no five are cospherical, that fills the box and its sides and leaves out what is nearer to the
/// soup than `clearance`. The box is the soup's, grown by `margin` on each side.
std::vector<Vec3d> backgroundPoints(const LatticeSoup& soup, double margin, double spacing,
                                    double clearance, Progress& progress);

} // namespace tetvdb
