// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/KeepResolution.h"

#include "tetvdb/volume/Grids.h"

namespace tetvdb {

double tooFine(const VoxelBox& box, const VoxelizeOptions& options) {
  double factor = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    double have = 0, max = options.resolution;
    if (options.fit.voxels > 0) {
      // Voxels from the cube's centre to the farther side.
      const double midpoint = (static_cast<double>(options.fit.voxels) - 1) / 2;
      have = std::max(midpoint - box.low[k], box.high[k] - midpoint) + 0.5;
      max = static_cast<double>(options.fit.voxels) / 2 - options.fit.padding;
    } else {
      have = static_cast<double>(box.high[k]) - box.low[k] + 1;
    }
    factor = std::max(factor, have / max);
  }
  return factor;
}

double tooFine(const Voxelization& made, const VoxelizeOptions& options) {
  if (made.counts.openEdges == 0)
    return 1;
  const openvdb::CoordBBox box = made.volume.grids().all.front()->evalActiveVoxelBoundingBox();
  if (box.empty())
    return 1;
  return tooFine(VoxelBox{{box.min().x(), box.min().y(), box.min().z()},
                          {box.max().x(), box.max().y(), box.max().z()}},
                 options);
}

void coarsen(const GridTransform& transform, double factor, VoxelizeOptions& used) {
  for (std::size_t k = 0; k < 3; ++k) {
    const double size = transform.voxelSize[k], larger = size * factor;
    used.voxelSize[k] = larger;
    if (used.fit.voxels > 0) // about the same centre
      used.origin[k] = transform.origin[k] + (size - larger) * (used.fit.voxels - 1) / 2;
  }
}

} // namespace tetvdb
