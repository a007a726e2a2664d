// SPDX-License-Identifier: Apache-2.0
//
// Layers of a sparse grid whose voxels are the pixels.
#pragma once

#include "tetvdb/print/GreyLevels.h"
#include "tetvdb/print/LayerSource.h"
#include "tetvdb/volume/Grids.h"

#include <cstdint>
#include <memory>

namespace tetvdb {

/// The pixel of a voxel: offset + voxel, or for a reversed axis offset - voxel; layers count upward
/// with z.
struct VoxelToPixel {
  std::int64_t x = 0, y = 0, z = 0;
  bool reverseX = false, reverseY = false;
};

/// Layers of a bool grid (active and true: white), an int32 grid (active voxels: their value, from
/// 1 to 255, as a material; others are omitted) or a float grid (shares of voxels, as in the grid
/// "coverage", limited to 0 to 1). Voxels outside of the frame are omitted. `grid` is not copied
/// and must not change. Cost: about 5 ns per row of 8 voxels of a leaf or tile. Throws Error(Usage)
/// for a grid of another type.
std::unique_ptr<LayerSource> gridLayers(openvdb::GridBase::ConstPtr grid, const LayerFrame& frame,
                                        const VoxelToPixel& map, const GreyLevels& levels);

} // namespace tetvdb
