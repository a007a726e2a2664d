// SPDX-License-Identifier: Apache-2.0
#include "VoxelizeSequence.h"

#include "Commands.h"
#include "JsonReport.h"
#include "NumberText.h"
#include "ProgressDisplay.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/pipeline/FitVolume.h"
#include "tetvdb/pipeline/PlannedStages.h"
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

// The grid "material" numbers files of triangles: they are parts of one volume.
bool numbersMaterials(const VoxelizeJob& job) {
  return job.inputs.size() > 1 && isNumbered(job.inputs) &&
         contains(job.grids, GridKind::Material) && holdsTriangles(job.inputs.front());
}

} // namespace

void addSequenceOptions(CLI::App& command, SequenceTexts& texts) {
  command
      .add_option(
          "--frames", texts.frames,
          "Frames of a sequence to take, counted from 1; makes a file that holds several steps one")
      ->type_name("all|FIRST:LAST[:STRIDE]")
      ->check(notEmpty());
  command.add_flag("--allow-gaps", texts.allowGaps,
                   "Take a pattern's files although numbers are missing");
  command.add_flag(
      "--union", texts.unite,
      "Lay numbered files, or a pattern's, together into one volume: they are no frames");
  command.add_flag("--again", texts.again, "Make frames that an earlier run has finished again");
}

std::vector<std::string> frameNames(const std::vector<std::string>& inputs,
                                    const std::string& output, const SequenceTexts& texts) {
  std::vector<std::string> names;
  try {
    Report report;
    Progress progress;
    const std::size_t count = texts.unite ? 0
                                          : findFrames(inputs, parseFrames(texts.frames),
                                                       texts.allowGaps, report, progress)
                                                .size();
    for (std::size_t i = 1; i <= count && !output.empty(); ++i)
      names.push_back(frameName(output, i, count));
  } catch (const Error&) { // the job says it
  }
  return names;
}

bool runAsSequence(VoxelizeJob& job, const SequenceTexts& texts, Session& session) {
  if (texts.unite && !texts.frames.empty())
    throw Error(Status::Usage, "--union", "makes one volume, but --frames asks for a sequence",
                "leave one of them out");
  if (texts.unite || numbersMaterials(job)) {
    job.inputs = filesOf(job.inputs);
    return false;
  }
  const std::vector<Frame> frames = findFrames(job.inputs, parseFrames(texts.frames),
                                               texts.allowGaps, session.report, session.progress);
  if (frames.empty())
    return false;
  if (job.output.empty())
    throw Error(Status::Usage, "", "no output was given", "name one with -o OUT.vdb");
  SequenceOptions options;
  options.again = texts.again;
  session.estimate.plan(plannedSequence(), secondsNow());
  const SequenceResult result = runSequence(job, frames, options, session.report, session.progress);
  session.sections["transform"] = worldFromIndex(result.transform);
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
  session.text = fmt::format("{} to {}: {} frame{}, {}", oneLine(result.frames.front().output.path),
                             oneLine(result.frames.back().output.path), result.frames.size(),
                             result.frames.size() == 1 ? "" : "s", bytesText(bytes));
  session.text += skipped == 0 ? "\n" : fmt::format(", {} of them there already\n", skipped);
  if (job.inputs.size() > 1)
    session.text +=
        "  numbered files are the frames of a sequence; --union makes one volume of them\n";
  session.textIsSummary = true;
  return true;
}

} // namespace tetvdb::cli
