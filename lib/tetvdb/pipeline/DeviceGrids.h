// SPDX-License-Identifier: Apache-2.0
//
// Grids that a device makes and that are written as they are.
#pragma once

#include "tetvdb/fields/SampleFields.h"
#include "tetvdb/pipeline/VoxelizeJob.h"
#include "tetvdb/volume/NanoBytes.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <functional>
#include <vector>

namespace tetvdb {

/// `nano` where all grids of the job can be written as a device makes them, else null.
std::vector<NanoBytes>* nanoPlace(const VoxelizeJob& job, std::vector<NanoBytes>& nano);

/// Adds the grids of makeOnDevice(), which the device makes, to its other grids, of which the last
/// is the mask that is not wanted unless `keepMask`. If makeOnDevice() returns none, the grids
/// become those of `made` in place of `nano`. Returns whether there are some.
bool addDeviceShapes(std::vector<NanoBytes>& nano, bool keepMask,
                     const std::function<std::vector<NanoBytes>()>& makeOnDevice,
                     Voxelization& made);

/// Makes OpenVDB's grids of `nano`, which becomes empty, and adds them to `made`.
void makeTrees(std::vector<NanoBytes>& nano, Voxelization& made);

/// Adds the grids of `fields` to those in `nano`, which a device has made, or which are none since
/// the fields are all; where the CPU makes them, or one of them has no leaves, all grids become
/// those of `made` in place of `nano`. `used`: for the fields.
SnapCounts addFields(std::vector<NanoBytes>& nano, const TetMesh& mesh,
                     const std::vector<Field>& fields, const SampleOptions& options,
                     const DeviceChoice& choice, DeviceUsed& used, Voxelization& made,
                     Report& report, Progress& progress);

} // namespace tetvdb
