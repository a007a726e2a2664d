// SPDX-License-Identifier: Apache-2.0
//
// `tetvdb voxelize` for sequences: --frames, --allow-gaps, --again.
#pragma once

#include "Session.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <CLI/CLI.hpp>
#include <string>

namespace tetvdb::cli {

struct SequenceTexts {
  std::string frames;
  bool allowGaps = false, again = false;
};

void addSequenceOptions(CLI::App& command, SequenceTexts& texts);

/// Runs `job` frame by frame where its inputs are a sequence, and fills the session's sections and
/// text; false where they are not.
bool runAsSequence(const VoxelizeJob& job, const SequenceTexts& texts, Session& session);

} // namespace tetvdb::cli
