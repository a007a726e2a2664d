// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/tetrahedralize/soup/Envelope.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

struct SimplifyCounts {
  std::size_t collapses = 0, swaps = 0;
};

/// Fewer triangles for the same surface, before any tet is made. Edges are collapsed, shortest
/// first, and swapped where neighbours are almost coplanar and the worst angle grows, as long as
/// every face stays within `radius` of `envelope` and no face's normal turns by 90 degrees or more;
/// removed points stay within `radius` of the faces that replace theirs, so that thin spikes are
/// not removed. Only edges of exactly two faces of one input change, and only points whose faces
/// form one closed fan move: boundary edges, non-manifold edges and contacts of inputs stay. New
/// points are lattice points. Faces keep their orientation and their input; the order of what stays
/// is kept. Parallel by parts of space whose borders move between rounds; the same result for any
/// number of threads. Keeps LatticeSoup's conditions.
/// Points that `fixed` is not 0 for stay; it has an entry a point, or
/// none at all.
SimplifyCounts simplifySoup(LatticeSoup& soup, const Envelope& envelope, double radius,
                            const std::vector<std::uint8_t>& fixed, Progress& progress);

} // namespace tetvdb
