// SPDX-License-Identifier: Apache-2.0
//
// Arrays into grids on the GPU, beside the CPU.
#pragma once

#include "nanovdb_kernels/DeviceVoxelizer.h"
#include "tetvdb/mesh/TetMesh.h"

#include <string>

namespace tetvdb::bench {

/// Two point arrays of one float and a cell array of three, sampled in a grid of `resolution`
/// across: on the device alone from pinned arrays to values in host memory that nobody takes, with
/// its floor, and as the program does it from arrays to OpenVDB's trees, the CPU beside it. `ball`
/// has radius 1. Prints the medians of `times` runs.
void fieldsTable(nano::DeviceVoxelizer& device, const nano::Speeds& speeds, const TetMesh& ball,
                 const std::string& name, int resolution, int times);

} // namespace tetvdb::bench
