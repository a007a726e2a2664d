// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/tetrahedralize/Envelope.h"
#include "tetvdb/tetrahedralize/LatticeSoup.h"

#include <cstddef>

namespace tetvdb {

struct SimplifyCounts {
  std::size_t collapses = 0, swaps = 0;
};

/// Fewer triangles for the same surface, before any tet is made. Edges are collapsed, shortest
/// first, and swapped where neighbours are almost coplanar and the worst angle grows, as long as
/// every face stays within `radius` of `envelope` and no face's normal turns by 90 degrees or more;
/// what went away stays within `radius` of the faces that took its place, so that thin spikes and
/// the like are not worn away. Only edges of exactly two faces of one input move, and only points
/// whose faces form one closed fan: rims, non-manifold edges and contacts of inputs stay. New
/// points are lattice points. Faces keep their orientation and their input; the order of what stays
/// is kept. Parallel by parts of space whose borders move between rounds; the same result for any
/// number of threads. Keeps LatticeSoup's promises.
SimplifyCounts simplifySoup(LatticeSoup& soup, const Envelope& envelope, double radius,
                            Progress& progress);

} // namespace tetvdb
