// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/tetrahedralize/LatticeSoup.h"
#include "tetvdb/tetrahedralize/TetComplex.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace tetvdb {

/// Lengths are in lattice units.
struct InsertSurfaceOptions {
  double spacing = 0;   ///< of points away from the surface
  double margin = 0;    ///< about the soup's box
  double clearance = 0; ///< what points in between keep from the surface
  double reach = 0;     ///< what a triangle's faces may be off it where tets are too flat to part
  std::function<void(TetComplex&)> coarsen; ///< as SoupInsertion's
};

struct InsertedSurface {
  LatticeSoup soup; ///< as it was inserted
  TetComplex complex;
  std::vector<std::uint32_t> missing; ///< faces of the soup that did not go in
};

/// A mesh of a soup's box with the soup's triangles as tracked faces: Delaunay tets of its points
/// and of points in between, into which the triangles go (InsertSoup.h). Where some do not, it is
/// tried again, those first, then with soupOf(1) instead of soupOf(0), up to `variants`; of all
/// tries the one that misses fewest counts. Writes parts "background" and "insert" to `timer`.
/// Parallel; the same mesh for any number of threads. `variants` is two or more. Throws
/// Error(Limit) where the first two are cut to more pieces than can be meshed.
InsertedSurface insertSurface(const std::function<LatticeSoup(int variant)>& soupOf, int variants,
                              std::size_t inputCount, const InsertSurfaceOptions& options,
                              StageTimer& timer, Progress& progress);

} // namespace tetvdb
