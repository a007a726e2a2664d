// SPDX-License-Identifier: Apache-2.0
//
// Closed triangle meshes into masks at 256^3 on the device.
#pragma once

#include "nanovdb_kernels/DeviceVoxelizer.h"

#include <string>
#include <vector>

namespace tetvdb::bench {

/// A sphere of 20,000 triangles: both methods, from the mesh in host memory to the grid there.
void soupTable(nano::DeviceVoxelizer& device, const nano::Speeds& speeds, int times);

/// `count` models, turned in different ways, of the closed meshes of at most 20,000 triangles in
/// `files`, or of spheres and tori where there are none: all are compared with the CPU's grids by
/// hash, then timed with 1, 2, 4 and 8 models at a time. Returns how many differ.
int manySoups(const nano::Speeds& speeds, const std::vector<std::string>& files, int count);

} // namespace tetvdb::bench
