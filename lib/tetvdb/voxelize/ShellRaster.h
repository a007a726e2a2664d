// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/Slab.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstdint>

namespace tetvdb {

/// Hands to `sink` the voxels whose centres are within `radius` of a face; distances in world
/// units, computed in doubles. Time follows the columns that the faces' grown boxes cover.
void rasterizeShell(const SnappedMesh& mesh, const Boundary& faces, const Vec3d& voxelSize,
                    double radius, NodeSink& sink, Progress& progress);

/// An upper estimate of the number of leaf nodes of that shell.
std::uint64_t estimateShellLeaves(const SnappedMesh& mesh, const Boundary& faces,
                                  const Vec3d& voxelSize, double radius);

} // namespace tetvdb
