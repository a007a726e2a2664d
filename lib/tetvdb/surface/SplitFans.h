// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// Makes a closed oriented surface manifold by separating faces that only touch. No point moves. At
/// an edge of more than two faces, each face is paired with the one that bounds the same wedge of
/// the solid. A point whose faces then form several fans is replaced by one point per fan, at the
/// same position. If two pairs still share an edge between the same two points, the edge of the
/// later pair is split at its midpoint. Faces keep their order; the second halves of split faces
/// are appended. Throws Error(Invalid) unless every edge is traversed equally often in both
/// directions.
void splitFans(TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
