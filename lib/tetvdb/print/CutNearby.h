// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>

namespace tetvdb {

struct NearbyCut {
  TriangleMesh taken;       ///< the part of the solid inside the tool, closed
  std::size_t cutFaces = 0; ///< of the solid
};

/// Subtracts `tool`, a closed mesh oriented outward, from `solid` by processing only faces close to
/// it: those within `reach` of `centre`, a ball that contains the tool. These are closed by walls
/// that extend straight away from the ball, so that winding numbers in it are those of the whole
/// solid up to a constant, and cut by removeCrossings(). The other faces are unchanged and come
/// first; the time depends on the faces nearby, plus one pass over all faces of about 60 ns each.
/// `solid` must be closed, manifold and free of self-intersections. Returns false, without changing
/// the solid, if the result does not match the other faces (every edge of two faces, volumes
/// equal), or if walls would intersect faces.
bool cutNearby(TriangleMesh& solid, const TriangleMesh& tool, const Vec3d& centre, double reach,
               NearbyCut& cut, Progress& progress);

} // namespace tetvdb
