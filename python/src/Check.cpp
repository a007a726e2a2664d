// SPDX-License-Identifier: Apache-2.0
#include "CheckReport.h"
#include "Functions.h"
#include "Inputs.h"
#include "Report.h"
#include "Settings.h"
#include "TakeModel.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <utility>

namespace tetvdb::python {
namespace {

using Json = nlohmann::ordered_json;

CheckPrintJob jobOf(Settings& settings) {
  CheckPrintJob job;
  settings.takeWord(
      "target", {{"sla", PrintTarget::Sla}, {"lpbf", PrintTarget::Lpbf}, {"fdm", PrintTarget::Fdm}},
      job.target);
  takeModel(settings, job.slice);
  job.plateKnown = completePrinter(job.target, job.slice.printer);
  if (!job.plateKnown && settings.has("place"))
    Settings::refuse("place", "needs a plate", "give `printer`, or `pixels` and `display`");
  job.slice.aa = SliceAa::Area;
  settings.takeWord("aa",
                    {{"volume", SliceAa::Volume}, {"area", SliceAa::Area}, {"none", SliceAa::None}},
                    job.slice.aa);
  job.limits = limitsFor(job.target);
  std::vector<std::string> checks;
  settings.take("checks", checks);
  std::string list;
  for (const std::string& check : checks)
    list += (list.empty() ? "" : ",") + check;
  if (settings.has("checks"))
    cli::chooseChecks("`checks`", list, job);
  PrintLimits& limits = job.limits;
  int connectivity = 8;
  settings.take("connectivity", connectivity);
  if (connectivity != 4 && connectivity != 8)
    Settings::refuse("connectivity", "cannot be used", "give 4 or 8");
  limits.neighbours = connectivity == 4 ? Neighbours::Four : Neighbours::Eight;
  takeNumber(settings, "overhang_angle", limits.overhangAngle);
  takeNumber(settings, "min_wall", limits.minWall);
  takeNumber(settings, "min_floor", limits.minFloor);
  takeNumber(settings, "min_gap", limits.minGap);
  takeNumber(settings, "drain", limits.drain);
  takeNumber(settings, "min_area", limits.minArea);
  takeNumber(settings, "min_volume", limits.minVolume);
  if (settings.has("picture"))
    job.picture = pathOf(settings.get("picture"));
  return job;
}

nb::object checkPrint(const nb::list& given, const nb::dict& keywords) {
  Settings settings(keywords);
  CheckPrintJob job = jobOf(settings);
  const JobLimits limits = settings.finish(job.slice);
  Inputs inputs = inputsOf(given);
  job.slice.isVolume = isVolume(inputs.names.front(), inputs.memory);
  job.slice.inputs = std::move(inputs.names);
  job.slice.memory = std::move(inputs.memory);
  JobRun work(limits);
  const std::string text = work([&](Report& report, Progress& progress) {
    const CheckPrintResult result = run(job, report, progress);
    Json sections = {{"stages", nullptr}};
    cli::addSections(job, result, cli::plainText, true, sections);
    const Status status = result.checks.findings.empty() ? statusOf(report) : Status::Found;
    return cli::reportText("check", status, "", report, sections);
  });
  return reportDict([&] { return text; });
}

nb::object checkVolumeFiles(const std::vector<std::string>& paths, const nb::dict& keywords) {
  Settings settings(keywords);
  CheckOptions options;
  settings.takeWord("target",
                    {{"blender", CheckTarget::Blender}, {"houdini", CheckTarget::Houdini}},
                    options.target);
  const JobLimits limits = settings.takeLimits();
  settings.finish();
  JobRun work(limits);
  const std::string text = work([&](Report& report, Progress& progress) {
    Json sections = {{"findings", Json::array()}};
    Status status = Status::Ok;
    for (const Finding& finding : checkVolumes(paths, options, progress)) {
      sections["findings"].push_back(cli::toJson(finding));
      if (finding.weight != Finding::Weight::Note)
        status = Status::Found;
    }
    return cli::reportText("check", status, "", report, sections);
  });
  return reportDict([&] { return text; });
}

} // namespace

void addCheck(nb::module_& module) {
  module.def("check_print", &checkPrint, nb::arg("inputs"), nb::arg("settings"),
             "Internal: tetvdb.check() for printers with its inputs told apart.");
  module.def("check_volumes", &checkVolumeFiles, nb::arg("paths"), nb::arg("settings"),
             "Internal: tetvdb.check() of volume files.");
}

} // namespace tetvdb::python
