// SPDX-License-Identifier: Apache-2.0
//
// Signed distance to the surface of a solid, in a narrow band around it.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/fields/DistanceBand.h"
#include "tetvdb/geometry/NarrowBand.h"
#include "tetvdb/geometry/NodeBox.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstddef>
#include <functional>

namespace tetvdb {

/// Passes a node's leaves of squared distances to a sink, as DistanceBand::rasterize() does.
using NodeLeaves = std::function<void(const DistanceBand::LeafSink&)>;
/// Receives node `node` of a band's nodes(); thread-safe.
using NodeTaker = std::function<void(std::size_t node, const NodeLeaves& leaves)>;
/// Passes each node of the band to `take` once, from several threads.
using BandRasterizer = std::function<void(const DistanceBand&, const NodeTaker& take, Progress&)>;

/// By DistanceBand::rasterize(), parallel by nodes.
void rasterizeBand(const DistanceBand& band, const NodeTaker& take, Progress& progress);

/// Returns a float level set "surface", negative inside. The sign is exactly that of `inside`
/// (active: inside). The absolute value is the distance to the nearest of `faces` in world units,
/// within kDistanceError voxels, for voxels closer than `halfWidth` voxels, which are active. All
/// others, and tiles, are inactive with plus or minus the background, halfWidth * voxelSize. An
/// inside voxel is negative also if its centre lies on a face. `inside` must have `transform`,
/// whose voxels must be cubes, and `faces` must be snapped by it. The result depends on the faces
/// as a set and on `inside` only. Parallel by nodes and leaves.
///
/// `shell`, voxels: the solid is the set of points within it of a face, and the absolute value is
/// the difference of the distance to the faces from it. Outside of the shell this is the distance
/// to the shell's surface, inside at most that distance.
///
/// `rasterize` computes the distances: rasterizeBand(), or a GPU (fields/DistanceOnDevice.h).
openvdb::FloatGrid::Ptr levelSet(const SnappedMesh& mesh, const Boundary& faces,
                                 const openvdb::BoolGrid& inside, const GridTransform& transform,
                                 double halfWidth, double shell, const BandRasterizer& rasterize,
                                 Progress& progress);

/// The nodes of `box` of that level set, its distances by rasterizeBand(). `band` has the radius
/// halfWidth + shell; `inside` must have the voxels of these nodes, others have no effect.
openvdb::FloatGrid::Ptr levelSetWithin(const NodeBox& box, const DistanceBand& band,
                                       const openvdb::BoolGrid& inside,
                                       const GridTransform& transform, double halfWidth,
                                       double shell, Progress& progress);

} // namespace tetvdb
