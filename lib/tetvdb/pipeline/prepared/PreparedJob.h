// SPDX-License-Identifier: Apache-2.0
//
// Voxelizes a prepared mesh.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

namespace tetvdb {

/// job.inputs is the folder of a prepared mesh. Throws Error(Usage) for settings that the folder
/// has fixed or that need the whole mesh, and for grids that it was not prepared for;
/// Error(Invalid) for files that are missing, damaged or foreign; Error(Limit) where a bucket does
/// not fit.
VoxelizeResult runPrepared(const VoxelizeJob& job, Report& report, Progress& progress);

} // namespace tetvdb
