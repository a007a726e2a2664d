// SPDX-License-Identifier: Apache-2.0
//
// Identifies a finished frame when a sequence is run again.
#pragma once

#include "tetvdb/pipeline/VoxelizeJob.h"

#include <string>

namespace tetvdb {

/// 32 hexadecimal digits of a hash of all data that determine the frame's volume: version, options,
/// and name, size and modification time of each input and of the files that it names. Does not
/// throw; a missing input counts as empty.
std::string frameMark(const VoxelizeJob& job);

/// Whether `path` is a .vdb file with metadata "job" equal to `mark`. Reads only the head of the
/// file; returns false if it cannot be read.
bool isFinished(const std::string& path, const std::string& mark);

} // namespace tetvdb
