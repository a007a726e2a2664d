// SPDX-License-Identifier: Apache-2.0
#include "CheckPrint.h"

#include "CheckReport.h"
#include "JsonReport.h"
#include "OptionNames.h"
#include "ProcessLimits.h"
#include "ProgressDisplay.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/pipeline/CheckPrintJob.h"
#include "tetvdb/pipeline/PlannedStages.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <set>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kShown = 10; // findings of a kind, as text

PrintTarget targetNamed(const std::string& name) {
  return name == "lpbf" ? PrintTarget::Lpbf : name == "fdm" ? PrintTarget::Fdm : PrintTarget::Sla;
}

CheckPrintJob makeJob(const CheckPrintOptions& options, const std::vector<std::string>& files,
                      const std::string& target) {
  CheckPrintJob job;
  job.target = targetNamed(target);
  job.slice = sliceJobFrom(options, files);
  job.plateKnown = completePrinter(job.target, job.slice.printer);
  if (!job.plateKnown && !options.place.empty())
    throw Error(Status::Usage, "--place", "needs a plate",
                "name the printer with --printer, or --pixels and --display");
  job.slice.aa = options.aa == "volume" ? SliceAa::Volume
                 : options.aa == "none" ? SliceAa::None
                                        : SliceAa::Area;
  setCleaning(options, job.slice.clean);
  job.slice.maxMemory = memoryLimit(options);
  job.slice.threads = threadCount(options);
  job.limits = limitsFor(job.target);
  if (!options.checks.empty())
    chooseChecks("--checks", options.checks, job);
  PrintLimits& limits = job.limits;
  limits.neighbours = options.connectivity == 4 ? Neighbours::Four : Neighbours::Eight;
  takeNumber("--overhang-angle", options.overhangAngle, limits.overhangAngle);
  takeNumber("--min-wall", options.minWall, limits.minWall);
  takeNumber("--min-floor", options.minFloor, limits.minFloor);
  takeNumber("--min-gap", options.minGap, limits.minGap);
  takeNumber("--drain", options.drain, limits.drain);
  takeNumber("--min-area", options.minArea, limits.minArea);
  takeNumber("--min-volume", options.minVolume, limits.minVolume);
  if (!options.picture.empty())
    requireExtension(options.picture, {".png"}, "name it .png");
  job.picture = options.picture;
  return job;
}

std::string linesOf(const CheckPrintResult& result, PrintTarget target) {
  std::string text;
  const std::vector<PrintFinding>& findings = result.checks.findings;
  for (std::size_t i = 0; i < findings.size();) {
    const PrintFault fault = findings[i].fault;
    std::size_t end = i;
    while (end < findings.size() && findings[end].fault == fault)
      ++end;
    for (std::size_t k = i; k < std::min(end, i + kShown); ++k)
      text += fmt::format("{}: {}; {}\n", nameOf(fault), withOptionNames(textOf(result, k)),
                          withOptionNames(cureFor(fault, target)));
    if (end - i > kShown)
      text += fmt::format("{}: {} more, smaller\n", nameOf(fault), end - i - kShown);
    i = end;
  }
  return text;
}

std::string summaryOf(const CheckPrintResult& result, bool plateKnown) {
  const LayerFrame& frame = result.slice.frame;
  const std::size_t found = result.checks.findings.size();
  std::size_t leftOut = 0;
  for (const std::size_t count : result.checks.leftOut)
    leftOut += count;
  return fmt::format(
      "{} layer{} of {:.4g} mm, pixels of {:.4g} x {:.4g} mm{}: {}{}\n", frame.layers,
      frame.layers == 1 ? "" : "s", frame.layerHeight, frame.pixelWidth, frame.pixelHeight,
      plateKnown ? "" : " (no printer is named)",
      found == 0 ? std::string("nothing found")
                 : fmt::format("{} finding{}", found, found == 1 ? "" : "s"),
      leftOut == 0 ? std::string() : fmt::format("; {} smaller ones are left out", leftOut));
}

} // namespace

void addCheckPrintOptions(CLI::App& command, CheckPrintOptions& options) {
  addPrinterOptions(command, options);
  addModelOptions(command, options);
  const auto add = [&](const char* name, std::string& value, const char* type,
                       const std::string& description) {
    return command.add_option(name, value, description)->type_name(type)->check(notEmpty());
  };
  add("--aa", options.aa, "RULE",
      "A pixel is solid if half of it is, in the layer's middle plane (area, the default) or in "
      "the whole layer (volume), or if its centre is (none)")
      ->check(CLI::IsMember({"area", "volume", "none"}).description(""));
  add("--checks", options.checks, "LIST",
      "Only these: outside, empty, islands, overhangs, cups, traps, drains, walls, "
      "floors, gaps");
  add("--overhang-angle", options.overhangAngle, "A",
      "Largest angle from the vertical without support, degrees (default sla 60, others 45)");
  add("--min-wall", options.minWall, "D",
      "Walls must be so wide, mm (default sla 0.5, lpbf 0.4, fdm 0.8)");
  add("--min-floor", options.minFloor, "D",
      "Floors and roofs must be so thick, mm (default as walls)");
  add("--min-gap", options.minGap, "D",
      "Gaps must be so wide, mm (default sla 0.3, lpbf 0.2, fdm 0.4)");
  add("--drain", options.drain, "D",
      "Ways out of a void must be so wide, mm (default sla 3.5, lpbf 2, fdm: not looked at)");
  add("--min-area", options.minArea, "A", "Leave smaller findings out, mm2 (default 0.1)");
  add("--min-volume", options.minVolume, "V",
      "Leave smaller cups and traps out, mm3 (default 0.1)");
  command
      .add_option("--connectivity", options.connectivity,
                  "Of solid pixels in a layer, 8 (default) or 4; the void has the other")
      ->check(CLI::IsMember({4, 8}).description(""))
      ->type_name("N");
  add("--picture", options.picture, "FILE.png",
      "Draw the model from above and from below with what was found");
  addCleaningOptions(command, options);
  addLimitOptions(command, options);
}

void runCheckPrint(const CheckPrintOptions& options, const std::vector<std::string>& files,
                   const std::string& target, Session& session) {
  Json inputs = Json::array();
  for (const std::string& file : files)
    inputs.push_back({{"path", file}});
  session.sections = {{"device", "cpu"},          {"threads", options.threads}, {"target", target},
                      {"input", inputs},          {"stages", nullptr},          {"print", nullptr},
                      {"findings", Json::array()}};
  const CheckPrintJob job = makeJob(options, files, target);
  session.sections["threads"] = job.slice.threads;
  limitProcess(options, session.progress);
  session.estimate.plan(plannedStages(job), secondsNow());
  const AllowThreads allowed(job.slice.threads);
  const CheckPrintResult result = run(job, session.report, session.progress);
  const bool wanted = !session.options.json.empty(); // some kB a finding
  addSections(job, result, withOptionNames, wanted, session.sections);
  session.text = linesOf(result, job.target) + summaryOf(result, job.plateKnown);
  session.textIsSummary = true;
  if (!result.checks.findings.empty())
    session.status = Status::Found;
}

} // namespace tetvdb::cli
