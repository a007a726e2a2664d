// SPDX-License-Identifier: Apache-2.0
//
// The paper's algorithm on the GPU, written from its description: one thread a tet, every voxel of
// its box, four determinants with strict signs, a dense grid of bits; memory taken and given back
// for every model.
#pragma once

#include "nanovdb_kernels/DeviceVoxelizer.h"

#include <cstdint>
#include <vector>

namespace tetvdb::bench {

struct PaperTimes {
  double allocation = 0, transfer = 0, kernel = 0, total = 0; ///< seconds
  std::uint64_t voxels = 0;
};

/// `mesh` in host memory; the grid's voxel (0, 0, 0) at `origin`, `n` voxels a side.
PaperTimes paperOnDevice(const nano::MeshView& mesh, const double (&origin)[3], double voxelSize,
                         int n);

} // namespace tetvdb::bench
