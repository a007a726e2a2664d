// SPDX-License-Identifier: Apache-2.0
//
// `tetvdb voxelize` for sequences: --frames, --allow-gaps, --again, --union.
#pragma once

#include "Session.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace tetvdb::cli {

struct SequenceTexts {
  std::string frames;
  bool allowGaps = false, again = false, unite = false;
};

void addSequenceOptions(CLI::App& command, SequenceTexts& texts);

/// The files that a sequence is written to; empty where the inputs are none, or cannot be read.
std::vector<std::string> frameNames(const std::vector<std::string>& inputs,
                                    const std::string& output, const SequenceTexts& texts);

/// Runs `job` frame by frame where its inputs are a sequence, and fills the session's sections and
/// text; false where they are not, or are to be one volume: its inputs are then the files that any
/// pattern among them represents.
bool runAsSequence(VoxelizeJob& job, const SequenceTexts& texts, Session& session);

} // namespace tetvdb::cli
