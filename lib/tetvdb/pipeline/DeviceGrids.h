// SPDX-License-Identifier: Apache-2.0
//
// Grids that a device makes and that are written as they are.
#pragma once

#include "tetvdb/pipeline/VoxelizeJob.h"
#include "tetvdb/volume/NanoBytes.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <functional>
#include <optional>
#include <vector>

namespace tetvdb {

/// `nano` where all grids of the job can be written as a device makes them, else null.
std::vector<NanoBytes>* nanoPlace(const VoxelizeJob& job, std::vector<NanoBytes>& nano);

/// Adds the level set of makeLevelSet(), which the device makes, to its other grids, of which the
/// last is the mask that is not wanted unless `keepMask`. If makeLevelSet() returns none, the grids
/// become those of `made` in place of `nano`. Returns whether there is one.
bool addLevelSet(std::vector<NanoBytes>& nano, bool keepMask,
                 const std::function<std::optional<NanoBytes>()>& makeLevelSet, Voxelization& made);

} // namespace tetvdb
