// SPDX-License-Identifier: Apache-2.0
//
// Signed distance to the surface of a solid, in a narrow band around it.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/fields/DistanceBand.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstddef>
#include <functional>

namespace tetvdb {

/// The half-widths that are allowed, voxels. From 1 on the voxels on either side of the surface are
/// always in the band, so that the level set is closed.
constexpr double kMinHalfWidth = 1, kMaxHalfWidth = 100;

/// Hands a node's leaves of squared distances to a sink, as DistanceBand::rasterize() does.
using NodeLeaves = std::function<void(const DistanceBand::LeafSink&)>;
/// Takes node `node` of a band's nodes(); thread-safe.
using NodeTaker = std::function<void(std::size_t node, const NodeLeaves& leaves)>;
/// Hands every node of the band to `take`, each once, from several threads.
using BandRasterizer = std::function<void(const DistanceBand&, const NodeTaker& take, Progress&)>;

/// By DistanceBand::rasterize(), parallel by nodes.
void rasterizeBand(const DistanceBand& band, const NodeTaker& take, Progress& progress);

/// A float level set "surface": negative inside. The sign is `inside`'s (active: inside), exactly;
/// the absolute value is the distance to the nearest of `faces` in world units, within
/// kDistanceError voxels, for voxels nearer than `halfWidth` voxels, which are active. All others,
/// and tiles, are inactive with plus or minus the background, halfWidth * voxelSize. A voxel inside
/// is below zero also where its centre lies on a face. `inside` must have `transform`, whose voxels
/// must be cubes, and `faces` be snapped by it. The result depends on the faces as a set and on
/// `inside` alone. Parallel by nodes and leaves.
///
/// `shell`, voxels: the solid is all that is within it of a face, and the absolute value is what
/// the distance to the faces differs from it by. That is the distance to the shell's surface
/// outside of the shell, and at most that within.
///
/// `rasterize` finds the distances: rasterizeBand(), or a GPU (fields/DistanceOnDevice.h).
openvdb::FloatGrid::Ptr levelSet(const SnappedMesh& mesh, const Boundary& faces,
                                 const openvdb::BoolGrid& inside, const GridTransform& transform,
                                 double halfWidth, double shell, const BandRasterizer& rasterize,
                                 Progress& progress);

} // namespace tetvdb
