// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// Makes a closed oriented surface manifold by parting what only touches, without moving anything.
/// Where more than two faces meet at an edge, each is paired with the one that bounds the same
/// wedge of the solid. A point whose faces then form several fans becomes a point for each, equal
/// in place; where two pairs still run between the same two points, the edge of the later pair gets
/// a point in its middle. Faces keep their order; those that are cut are followed by nothing new
/// but the second halves at the end. Throws Error(Invalid) unless every edge is run along as often
/// in one direction as in the other.
void splitFans(TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
