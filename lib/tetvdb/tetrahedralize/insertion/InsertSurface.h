// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace tetvdb {

/// Lengths are in lattice units.
struct InsertSurfaceOptions {
  double spacing = 0;   ///< of points in between
  double margin = 0;    ///< about the soup's box
  double clearance = 0; ///< distance of these points from the surface
  double reach = 0; ///< how far a triangle's faces may be from it where tets are too flat to be cut
  std::function<void(TetComplex&)> coarsen; ///< as SoupInsertion's
};

struct InsertedSurface {
  LatticeSoup soup; ///< as it was inserted
  TetComplex complex;
  std::vector<std::uint32_t> missing; ///< faces of the soup that did not go in
};

/// A mesh of a soup's box with the soup's triangles as tracked faces: Delaunay tets of its points
/// and of points in between, into which the triangles are inserted (InsertSoup.h). Where some are
/// missing, they are inserted first in another attempt, then soupOf(1) is taken instead of
/// soupOf(0), up to `variants`. Returns the attempt with the fewest missing faces. Writes parts
/// "background" and "insert" to `timer`. Parallel; the same mesh for any number of threads.
/// `variants` is two or more. Throws Error(Limit) where the first two variants need more tets than
/// can be meshed.
InsertedSurface insertSurface(const std::function<LatticeSoup(int variant)>& soupOf, int variants,
                              std::size_t inputCount, const InsertSurfaceOptions& options,
                              StageTimer& timer, Progress& progress);

} // namespace tetvdb
