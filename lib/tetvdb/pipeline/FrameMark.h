// SPDX-License-Identifier: Apache-2.0
//
// By what a frame that is finished is known when a sequence is run again.
#pragma once

#include "tetvdb/pipeline/VoxelizeJob.h"

#include <string>

namespace tetvdb {

/// 32 hexadecimal digits over all that the frame's volume depends on: version, options, and name,
/// size and time of change of each input. Throws nothing; an input that is missing counts as empty.
std::string frameMark(const VoxelizeJob& job);

/// Whether `path` is a .vdb file with metadata "job" equal to `mark`. Reads the head of the file
/// alone; false for whatever cannot be read.
bool isFinished(const std::string& path, const std::string& mark);

} // namespace tetvdb
