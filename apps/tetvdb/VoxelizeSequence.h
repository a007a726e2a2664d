// SPDX-License-Identifier: Apache-2.0
//
// `tetvdb voxelize` for sequences: --frames, --allow-gaps, --again, --union.
#pragma once

#include "FrameOptions.h"
#include "Session.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace tetvdb::cli {

struct SequenceTexts : FrameTexts {
  bool again = false, unite = false;
};

void addSequenceOptions(CLI::App& command, SequenceTexts& texts);

/// Runs `job` frame by frame where its inputs are a sequence, and fills the session's sections and
/// text; false where they are not, or are to be one volume: its inputs are then the files that any
/// pattern among them represents.
bool runAsSequence(VoxelizeJob& job, const SequenceTexts& texts, Session& session);

} // namespace tetvdb::cli
