// SPDX-License-Identifier: Apache-2.0
//
// What a ConvertJob of a volume converts. Internal.
#pragma once

#include "tetvdb/pipeline/ConvertJob.h"

namespace tetvdb {

/// Reads the job's volume, or its arrays, and leaves the chosen grids in their order. Throws the
/// errors of readVolumeInput(), readArrays() and chooseGrids(), and Error(Invalid) for arrays of
/// the background alone unless job.allowEmpty is set.
Volume readConverted(const ConvertJob& job, Report& report, Progress& progress);

} // namespace tetvdb
