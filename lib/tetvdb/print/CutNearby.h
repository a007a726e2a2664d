// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct NearbyCut {
  TriangleMesh taken;       ///< the part of the solid that lay in the tool, closed
  std::size_t cutFaces = 0; ///< of the solid
};

/// Takes `tool`, a closed mesh turned outward, out of `solid` by faces near it alone: those within
/// `reach` of `centre`, a ball that the tool lies in. These are closed by walls that go straight
/// away from the ball, so that winding numbers in it are those of the whole solid but for a
/// constant, and cut by removeCrossings(). The other faces stay as they are, and first; time
/// follows the faces nearby, but for one look at all of them, about 60 ns each. `solid` is closed,
/// manifold and free of self-intersections. Returns false, with the solid as it was, where what
/// comes back does not fit into the rest (every edge of two faces, volumes equal), or where walls
/// would meet faces.
bool cutNearby(TriangleMesh& solid, const TriangleMesh& tool, const Vec3d& centre, double reach,
               NearbyCut& cut, Progress& progress);

} // namespace tetvdb
