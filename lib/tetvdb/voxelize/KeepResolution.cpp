// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/KeepResolution.h"

#include "tetvdb/volume/Grids.h"

namespace tetvdb {

double tooFine(const Voxelization& made, const VoxelizeOptions& options) {
  if (made.counts.openEdges == 0)
    return 1; // within the box
  const openvdb::CoordBBox box = made.volume.grids().all.front()->evalActiveVoxelBoundingBox();
  if (box.empty())
    return 1;
  double factor = 1;
  for (int k = 0; k < 3; ++k) {
    double have = 0, max = options.resolution;
    if (options.fit.voxels > 0) {
      // Voxels from the cube's middle to the farther side.
      const double midpoint = (static_cast<double>(options.fit.voxels) - 1) / 2;
      have = std::max(midpoint - box.min()[k], box.max()[k] - midpoint) + 0.5;
      max = static_cast<double>(options.fit.voxels) / 2 - options.fit.padding;
    } else {
      have = static_cast<double>(box.max()[k]) - box.min()[k] + 1;
    }
    factor = std::max(factor, have / max);
  }
  return factor;
}

} // namespace tetvdb
