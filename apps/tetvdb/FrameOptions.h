// SPDX-License-Identifier: Apache-2.0
//
// The options of commands that work frame by frame on a sequence.
#pragma once

#include "tetvdb/pipeline/SequenceJob.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace tetvdb::cli {

struct FrameTexts {
  std::string frames;
  bool allowGaps = false;
};

/// --frames and --allow-gaps.
void addFrameOptions(CLI::App& command, FrameTexts& texts);

/// The frames that `inputs` and the options represent: findFrames().
std::vector<Frame> framesOf(const std::vector<std::string>& inputs, const FrameTexts& texts,
                            Report& report, Progress& progress);

/// The files that a sequence is written to; empty where the inputs are none, or cannot be read.
std::vector<std::string> frameNames(const std::vector<std::string>& inputs,
                                    const std::string& output, const FrameTexts& texts);

/// The files of a sequence, their number and size; a line.
std::string framesText(const std::vector<FrameResult>& results);

} // namespace tetvdb::cli
