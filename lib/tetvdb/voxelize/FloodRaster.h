// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/surface/TriangleScene.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/Slab.h"
#include "tetvdb/voxelize/SnappedMesh.h"

namespace tetvdb {

/// Hands to `sink` every voxel that cannot be reached from outside along straight lines between the
/// centres of neighbours (six of them) that no face crosses. Lines reach a hundredth of a voxel
/// beyond their ends, so that a centre that close to a face is cut off. Through a hole that lets a
/// line pass everything behind it is outside. `scene` holds the faces in world space, by
/// `transform`. Memory and time follow the area of the faces and of the box seen along z (12 bytes
/// for every voxel beside a face and for every gap in a column), not its volume.
void rasterizeFlood(const SnappedMesh& mesh, const Boundary& faces, const TriangleScene& scene,
                    const GridTransform& transform, NodeSink& sink, Progress& progress);

} // namespace tetvdb
