// SPDX-License-Identifier: Apache-2.0
//
// voxelize() on a GPU: the same grids, built by nanovdb_kernels.
#pragma once

#include "tetvdb/volume/NanoBytes.h"
#include "tetvdb/voxelize/DeviceChoice.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

/// Seconds that a job is expected to take; from making the device ready to OpenVDB's trees.
struct DeviceCost {
  double cpu = 0, device = 0;
};
DeviceCost estimateCost(const TetMesh& mesh, const GridTransform& transform,
                        const VoxelizeOptions& options);
/// The same of fields/SampleOnDevice.h, for fields of so many numbers a voxel in all.
DeviceCost estimateFieldCost(const TetMesh& mesh, const GridTransform& transform, double numbers);

/// The same of fields/DistanceOnDevice.h, for so many leaves of a band and faces.
DeviceCost estimateBandCost(double leaves, double faces);

/// Throws Error(Device) where `choice` names a GPU that is not there.
void requireDevice(const DeviceChoice& choice);

/// voxelize() on the device of `choice`. Where it is Auto and the device fails or has too little
/// memory the CPU does it, with a warning ("device-left"). Adds stages "upload", "voxelize" and
/// "download" to `report` where the GPU is used; making OpenVDB's trees is a part of "download".
/// `nano`, unless null, receives the grids as NanoVDB where the GPU made them, else nothing.
/// Throws what voxelize() throws, Error(Device) where the device fails.
Voxelization voxelize(const TetMesh& mesh, const VoxelizeOptions& options,
                      const DeviceChoice& choice, DeviceUsed& used, std::vector<NanoBytes>* nano,
                      Report& report, Progress& progress);

} // namespace tetvdb
