// SPDX-License-Identifier: Apache-2.0
#include "FrameOptions.h"

#include "Commands.h"
#include "JsonReport.h"
#include "NumberText.h"
#include "ParseQuantities.h"
#include "tetvdb/core/Error.h"

#include <fmt/format.h>

namespace tetvdb::cli {

void addFrameOptions(CLI::App& command, FrameTexts& texts) {
  command
      .add_option(
          "--frames", texts.frames,
          "Frames of a sequence to take, counted from 1; makes a file that holds several steps one")
      ->type_name("all|FIRST:LAST[:STRIDE]")
      ->check(notEmpty());
  command.add_flag("--allow-gaps", texts.allowGaps,
                   "Take a pattern's files although numbers are missing");
}

std::vector<Frame> framesOf(const std::vector<std::string>& inputs, const FrameTexts& texts,
                            Report& report, Progress& progress) {
  return findFrames(inputs, parseFrames("--frames", texts.frames), texts.allowGaps, report,
                    progress);
}

std::vector<std::string> frameNames(const std::vector<std::string>& inputs,
                                    const std::string& output, const FrameTexts& texts) {
  std::vector<std::string> names;
  try {
    Report report;
    Progress progress;
    const std::size_t count = framesOf(inputs, texts, report, progress).size();
    for (std::size_t i = 1; i <= count && !output.empty(); ++i)
      names.push_back(frameName(output, i, count));
  } catch (const Error&) { // the job says it
  }
  return names;
}

std::string framesText(const std::vector<FrameResult>& results) {
  std::uint64_t bytes = 0;
  std::size_t skipped = 0;
  for (const FrameResult& frame : results) {
    bytes += frame.output.bytes;
    skipped += frame.skipped ? 1 : 0;
  }
  std::string text = fmt::format("{} to {}: {} frame{}, {}", oneLine(results.front().output.path),
                                 oneLine(results.back().output.path), results.size(),
                                 results.size() == 1 ? "" : "s", bytesText(bytes));
  return text + (skipped == 0 ? "\n" : fmt::format(", {} of them there already\n", skipped));
}

} // namespace tetvdb::cli
