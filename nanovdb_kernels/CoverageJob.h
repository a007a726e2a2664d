// SPDX-License-Identifier: Apache-2.0
//
// The input of DeviceVoxelizer::coverage(): faces, and the slabs of voxels that they may pass
// through. Contains no type of CUDA or NanoVDB.
#pragma once

#include "tetvdb/geometry/SlabVolume.h"

#include <cstdint>
#include <string>

namespace tetvdb::nano {

/// Faces placed among slabs of 8 x 128 x 128 voxels, as CoverageFaces of fields/Coverage.h places
/// them; arrays in host memory.
struct CoverageJob {
  const Vec3d* points = nullptr; ///< the cube of voxel i is [i, i + 1]
  std::uint64_t pointCount = 0;
  const std::uint32_t* faces = nullptr; ///< three points each, and their weight, an int32
  std::uint64_t faceCount = 0;
  const FaceInSlab* pairs = nullptr;     ///< by slab, these by x, y and z
  const std::uint64_t* starts = nullptr; ///< of each slab's in `pairs`, and their number
  std::uint64_t slabCount = 0;
  double voxelSize[3] = {1, 1, 1}; ///< world units
  double origin[3] = {0, 0, 0};    ///< world units: the centre of voxel (0, 0, 0)
  std::string name = "coverage";   ///< at most 255 bytes
  bool download = true;            ///< false: the buffer stays on the device
};

} // namespace tetvdb::nano
