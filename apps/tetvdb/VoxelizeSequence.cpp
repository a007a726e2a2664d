// SPDX-License-Identifier: Apache-2.0
#include "VoxelizeSequence.h"

#include "Commands.h"
#include "JsonReport.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/pipeline/SequenceJob.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <optional>
#include <utility>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

// "all", "FIRST:LAST" or "FIRST:LAST:STRIDE"; LAST may be left out.
std::optional<FrameRange> parseFrames(const std::string& text) {
  if (text.empty())
    return {};
  FrameRange range;
  if (text == "all")
    return range;
  const auto refuse = [&] {
    throw Error(Status::Usage, "--frames", "'" + text + "' cannot be used",
                "give all, FIRST:LAST or FIRST:LAST:STRIDE, counted from 1");
  };
  std::size_t* const places[3] = {&range.first, &range.last, &range.stride};
  std::string_view left = text;
  std::size_t place = 0;
  while (true) {
    const std::string_view digits = left.substr(0, left.find(':'));
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), *places[place]);
    const bool leftOut = place == 1 && digits.empty();
    if (!leftOut &&
        (error != std::errc() || end != digits.data() + digits.size() || *places[place] == 0))
      refuse();
    if (digits.size() == left.size())
      break;
    left.remove_prefix(digits.size() + 1);
    if (++place == 3)
      refuse();
  }
  if (place == 0) // one frame
    range.last = range.first;
  return range;
}

Json framesOf(const SequenceResult& result) {
  Json list = Json::array();
  for (std::size_t i = 0; i < result.frames.size(); ++i) {
    const FrameResult& frame = result.frames[i];
    list.push_back({{"frame", i + 1},
                    {"input", frame.frame.inputs},
                    {"time", frame.frame.time ? Json(*frame.frame.time) : Json()},
                    {"output", frame.output.path},
                    {"skipped", frame.skipped},
                    {"grids", toJson(frame.grids)}});
  }
  return list;
}

} // namespace

void addSequenceOptions(CLI::App& command, SequenceTexts& texts) {
  command
      .add_option("--frames", texts.frames,
                  "Frames of a sequence to take, counted from 1; makes an Exodus or XDMF file one")
      ->type_name("all|FIRST:LAST[:STRIDE]")
      ->check(notEmpty());
  command.add_flag("--allow-gaps", texts.allowGaps,
                   "Take a pattern's files although numbers are missing");
  command.add_flag("--again", texts.again, "Make frames that an earlier run has finished anew");
}

bool runAsSequence(const VoxelizeJob& job, const SequenceTexts& texts, Session& session) {
  const std::vector<Frame> frames = findFrames(job.inputs, parseFrames(texts.frames),
                                               texts.allowGaps, session.report, session.progress);
  if (frames.empty())
    return false;
  if (job.output.empty())
    throw Error(Status::Usage, "", "no output was given", "name one with -o OUT.vdb");
  SequenceOptions options;
  options.again = texts.again;
  const SequenceResult result = runSequence(job, frames, options, session.report, session.progress);
  session.sections["frames"] = framesOf(result);
  session.sections["frames_at_once"] = result.atOnce;
  Json outputs = Json::array();
  std::uint64_t bytes = 0;
  std::size_t skipped = 0;
  for (const FrameResult& frame : result.frames) {
    outputs.push_back({{"path", frame.output.path}, {"bytes", frame.output.bytes}});
    bytes += frame.output.bytes;
    skipped += frame.skipped ? 1 : 0;
  }
  session.sections["output"] = std::move(outputs);
  for (const FrameResult& frame : result.frames)
    if (!frame.grids.empty()) {
      session.sections["grids"] = toJson(frame.grids);
      break;
    }
  session.text =
      fmt::format("{} to {}: {} frame{}, {:.1f} MB", oneLine(result.frames.front().output.path),
                  oneLine(result.frames.back().output.path), result.frames.size(),
                  result.frames.size() == 1 ? "" : "s", static_cast<double>(bytes) / 1e6);
  session.text += skipped == 0 ? "\n" : fmt::format(", {} of them there already\n", skipped);
  session.textIsSummary = true;
  return true;
}

} // namespace tetvdb::cli
