// SPDX-License-Identifier: Apache-2.0
#include "Functions.h"
#include "Grids.h"
#include "Inputs.h"
#include "KeptResult.h"
#include "ParseFields.h"
#include "ParseQuantities.h"
#include "Settings.h"
#include "tetvdb/core/InArena.h"
#include "tetvdb/pipeline/PrepareMesh.h"
#include "tetvdb/pipeline/SequenceJob.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <algorithm>
#include <limits>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <utility>

namespace tetvdb::python {
namespace {

// Names that are no grid of ours are arrays of the mesh.
void takeGrids(Settings& settings, VoxelizeJob& job) {
  std::vector<std::string> names;
  settings.take("grid", names);
  if (names.empty())
    return;
  job.grids.clear();
  for (const std::string& name : names) {
    if (const std::optional<GridKind> kind = gridKindOf(name))
      job.grids.push_back(*kind);
    else if (name == "all")
      job.fields.all = true;
    else
      job.fields.requests.push_back({"", name, FieldPart::Whole, ""});
  }
}

void takeFilter(Settings& settings, VoxelizeJob& job) {
  settings.take("region", job.filter.regions);
  settings.take("exclude", job.filter.exclude);
  settings.take("region_array", job.read.regionArray);
  std::vector<std::string> sides;
  settings.take("bbox", sides);
  if (sides.empty())
    return;
  std::vector<double> numbers;
  for (const std::string& side : sides) {
    std::size_t used = 0;
    double number = std::numeric_limits<double>::quiet_NaN();
    try {
      number = std::stod(side, &used);
    } catch (const std::exception&) {
    }
    if (used != side.size() || number != number)
      Settings::refuse("bbox", "'" + side + "' is no number", "give x0, y0, z0, x1, y1, z1");
    numbers.push_back(number);
  }
  if (numbers.size() != 6)
    Settings::refuse("bbox", "does not have six numbers",
                     "give x0, y0, z0, x1, y1, z1; inf and -inf leave a side open");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    job.filter.boxMin[axis] = std::min(numbers[axis], numbers[axis + 3]);
    job.filter.boxMax[axis] = std::max(numbers[axis], numbers[axis + 3]);
  }
}

void takeHalfWidth(Settings& settings, double& halfWidth) {
  if (!settings.has("half_width"))
    return;
  const nb::object given = settings.get("half_width");
  if (nb::isinstance<nb::str>(given) && nb::cast<std::string>(given) == "all")
    halfWidth = kWholeBox;
  else
    settings.takeLength("half_width", halfWidth);
}

void takeFields(Settings& settings, VoxelizeJob& job) {
  cli::FieldTexts texts;
  settings.take("derive", texts.derive);
  settings.take("remap", texts.remap);
  settings.take("clamp", texts.clamp);
  settings.take("background", texts.background);
  settings.take("warp", texts.warp);
  settings.take("smooth", job.smooth);
  const cli::SettingName settingName = [](const char* name) {
    return "`" + std::string(name) + "`";
  };
  cli::setFields(texts, settingName, job.fields);
  if (!texts.warp.empty())
    job.warp = cli::parseWarp("`warp`", texts.warp);
}

VoxelizeJob voxelizeJobOf(Settings& settings) {
  VoxelizeJob job;
  settings.takeSize(job.voxelize.voxelSize, job.voxelize.resolution);
  settings.takePoint("origin", job.voxelize.origin);
  settings.take("fit", job.voxelize.fit.voxels);
  settings.take("padding", job.voxelize.fit.padding);
  if (settings.has("fit") &&
      (settings.has("voxel_size") || settings.has("resolution") || settings.has("origin")))
    Settings::refuse("fit", "goes with none of `resolution`, `voxel_size` and `origin`",
                     "leave one of them out");
  takeGrids(settings, job);
  takeFilter(settings, job);
  takeHalfWidth(settings, job.shapes.halfWidth);
  settings.takeWord(
      "rule", {{"centre", VoxelRule::Centre}, {"any", VoxelRule::Any}, {"all", VoxelRule::All}},
      job.voxelize.rule);
  settings.take("half", job.half);
  settings.takeWord("up_axis", {{"z", UpAxis::Z}, {"y", UpAxis::Y}}, job.up);
  settings.take("units", job.units);
  settings.take("allow_empty", job.voxelize.allowEmpty);
  settings.takeWord(
      "mesher",
      {{"auto", Mesher::Auto}, {"envelope", Mesher::Envelope}, {"winding", Mesher::Winding}},
      job.mesher);
  settings.takeRelative("epsilon", job.epsilon, true);
  settings.takeInside(job.solid);
  settings.takeWord(
      "shell_side",
      {{"both", ShellSide::Both}, {"outward", ShellSide::Outward}, {"inward", ShellSide::Inward}},
      job.solid.side);
  settings.takeCleaning(job.clean);
  std::string device = "auto";
  settings.take("device", device);
  job.device = cli::parseDevice("`device`", device);
  takeFields(settings, job);
  if (settings.has("write_mesh"))
    job.meshOutput = pathOf(settings.get("write_mesh"));
  if (settings.has("preview"))
    job.preview = pathOf(settings.get("preview"));
  job.read.attributes = !job.meshOutput.empty() || !job.fields.empty() || !job.warp.array.empty();
  return job;
}

nb::object voxelizeInputs(const nb::list& given, const nb::dict& keywords) {
  Settings settings(keywords);
  VoxelizeJob job = voxelizeJobOf(settings);
  job.keep = true;
  const JobLimits limits = settings.finish(job);
  Inputs inputs = inputsOf(given);
  job.inputs = std::move(inputs.names);
  job.memory = std::move(inputs.memory);
  return keptResult("voxelize", std::move(job), limits, [](Volume volume, ReportText report) {
    return volumeObject(std::move(volume), std::move(report));
  });
}

// Files in, a file out: only the report is returned, and what is larger than memory is streamed.
nb::object voxelizeFile(const std::vector<std::string>& inputs, nb::handle output,
                        const nb::dict& keywords) {
  Settings settings(keywords);
  VoxelizeJob job = voxelizeJobOf(settings);
  const JobLimits limits = settings.finish(job);
  // The library cannot tell it from the default.
  if (settings.has("resolution") && std::any_of(inputs.begin(), inputs.end(), isPreparedMesh))
    Settings::refuse("resolution", "was decided when the mesh was prepared",
                     "leave it out, or prepare the mesh again");
  job.inputs = inputs;
  job.output = pathOf(output);
  JobRun work(limits);
  const std::string text = work([&](Report& report, Progress& progress) {
    const VoxelizeResult result = run(job, report, progress);
    return cli::reportText("voxelize", statusOf(report), "", report, cli::sectionsOf(job, result));
  });
  return reportDict([&] { return text; });
}

nb::object prepareInput(const std::string& input, nb::handle folder, const nb::dict& keywords) {
  Settings settings(keywords);
  VoxelizeJob job = voxelizeJobOf(settings);
  const JobLimits limits = settings.finish(job);
  job.inputs = {input};
  const std::string to = pathOf(folder);
  JobRun work(limits);
  const std::string text = work([&](Report& report, Progress& progress) {
    return inArena(job.threads, [&] {
      const PreparedMesh mesh = prepareMesh(job, to, report, progress);
      const nlohmann::ordered_json sections = {{"threads", cli::threadsOf(job.threads)},
                                               {"input", {{{"path", input}}}},
                                               {"prepared", cli::preparedSection(mesh, to)},
                                               {"stages", nullptr}};
      return cli::reportText("plan", statusOf(report), "", report, sections);
    });
  });
  return reportDict([&] { return text; });
}

// Files in, files out: only the report is returned.
nb::object voxelizeFrames(const std::vector<std::string>& inputs, nb::handle output,
                          const nb::dict& keywords) {
  Settings settings(keywords);
  VoxelizeJob job = voxelizeJobOf(settings);
  std::string range;
  settings.take("frames", range);
  bool allowGaps = false;
  settings.take("allow_gaps", allowGaps);
  SequenceOptions options;
  settings.take("again", options.again);
  const JobLimits limits = settings.finish(job);
  job.inputs = inputs;
  job.output = pathOf(output);
  JobRun work(limits);
  const std::string text = work([&](Report& report, Progress& progress) {
    const std::vector<Frame> frames =
        findFrames(inputs, cli::parseFrames("`frames`", range), allowGaps, report, progress);
    if (frames.empty())
      throw Error(Status::Usage, inputs.empty() ? "" : inputs.front(), "is no sequence",
                  "give `frames`, or use voxelize()");
    nlohmann::ordered_json sections = {{"stages", nullptr}};
    cli::addSections(runSequence(job, frames, options, report, progress), sections);
    return cli::reportText("voxelize", statusOf(report), "", report, sections);
  });
  return reportDict([&] { return text; });
}

} // namespace

void addVoxelize(nb::module_& module) {
  module.def("voxelize", &voxelizeInputs, nb::arg("inputs"), nb::arg("settings"),
             "Internal: tetvdb.voxelize() with its inputs told apart.");
  module.def("voxelize_file", &voxelizeFile, nb::arg("inputs"), nb::arg("output"),
             nb::arg("settings"), "Internal: tetvdb.voxelize_file() with paths as texts.");
  module.def("prepare_mesh", &prepareInput, nb::arg("input"), nb::arg("folder"),
             nb::arg("settings"), "Internal: tetvdb.prepare_mesh() with paths as texts.");
  module.def("voxelize_frames", &voxelizeFrames, nb::arg("inputs"), nb::arg("output"),
             nb::arg("settings"), "Internal: tetvdb.voxelize_frames() with paths as texts.");
}

} // namespace tetvdb::python
