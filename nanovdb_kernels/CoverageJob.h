// SPDX-License-Identifier: Apache-2.0
//
// The input and the results of DeviceVoxelizer::coverage(): the volumes that faces cut off the
// cubes of voxels, slab by slab. Contains no type of CUDA or NanoVDB.
#pragma once

#include "tetvdb/geometry/SlabVolume.h"

#include <cstdint>

namespace tetvdb::nano {

/// Faces placed among slabs of 8 x 128 x 128 voxels, as fields/Coverage.h places them; arrays in
/// host memory.
struct CoverageJob {
  const Vec3d* points = nullptr; ///< the cube of voxel i is [i, i + 1]
  std::uint64_t pointCount = 0;
  const std::uint32_t* faces = nullptr; ///< three points each, and their weight, an int32
  std::uint64_t faceCount = 0;
  const FaceInSlab* pairs = nullptr;     ///< by slab
  const std::uint64_t* starts = nullptr; ///< of each slab's in `pairs`, and their number
  std::uint64_t slabCount = 0;
};

/// Slabs of the job, in its order.
struct CoverageBatch {
  std::uint64_t firstSlab = 0, slabCount = 0;
  const std::uint64_t* starts = nullptr; ///< of each slab's leaves in the batch, and their number
  const std::uint16_t* leaves = nullptr; ///< that faces meet: y * 16 + z, ascending
  const std::int64_t* sums = nullptr;    ///< kSumsOfLeaf a leaf (SlabVolume.h)
};

class CoverageReceiver {
public:
  virtual ~CoverageReceiver() = default;
  /// Receives every slab once, in order. The batch is invalid after the return.
  virtual void take(const CoverageBatch& batch) = 0;
};

} // namespace tetvdb::nano
