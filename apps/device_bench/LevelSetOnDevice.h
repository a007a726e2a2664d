// SPDX-License-Identifier: Apache-2.0
//
// Level sets with distances from the GPU, beside the CPU.
#pragma once

#include "nanovdb_kernels/DeviceVoxelizer.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <string>

namespace tetvdb::bench {

/// A level set of half-width 3 in a grid of `resolution` across: on the device alone, from pinned
/// arrays to distances in host memory that nobody takes, and to a grid of NanoVDB in host memory,
/// with their floors; and as the program does it from a mesh and its mask to OpenVDB's tree, the
/// CPU beside it. `ball` has radius 1. Prints the medians of `times` runs.
void levelSetTable(nano::DeviceVoxelizer& device, const nano::Speeds& speeds, const TetMesh& ball,
                   const std::string& name, int resolution, int times);
void levelSetTable(nano::DeviceVoxelizer& device, const nano::Speeds& speeds,
                   const TriangleMesh& ball, const std::string& name, int resolution, int times);

} // namespace tetvdb::bench
