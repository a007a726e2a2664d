// SPDX-License-Identifier: Apache-2.0
#include "Functions.h"
#include "Grids.h"
#include "Inputs.h"
#include "JobReport.h"
#include "Settings.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <limits>
#include <memory>
#include <nanobind/stl/string.h>
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

VoxelizeJob jobOf(Settings& settings) {
  VoxelizeJob job;
  job.keep = true;
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
  settings.takeWord(
      "device", {{"auto", DeviceKind::Auto}, {"cpu", DeviceKind::Cpu}, {"cuda", DeviceKind::Cuda}},
      job.device.kind);
  if (job.device.kind != DeviceKind::Cpu)
    job.device.numbers = {0};
  job.read.attributes = !job.fields.empty();
  return job;
}

nb::object voxelizeInputs(const nb::list& given, const nb::dict& keywords) {
  Settings settings(keywords);
  VoxelizeJob job = jobOf(settings);
  const JobLimits limits = settings.finish(job);
  Inputs inputs = inputsOf(given);
  job.inputs = std::move(inputs.names);
  job.memory = std::move(inputs.memory);

  struct Done {
    VoxelizeJob job;
    VoxelizeResult result;
    Report report;
  };
  auto done = std::make_shared<Done>();
  JobRun work(limits);
  done->result =
      work([&](Report& report, Progress& progress) { return run(job, report, progress); });
  Volume volume = std::move(*done->result.kept);
  done->result.kept.reset();
  job.memory.clear(); // the caller's arrays
  done->job = std::move(job);
  done->report = std::move(work.report());
  return volumeObject(std::move(volume), [done] {
    return cli::reportText("voxelize", statusOf(done->report), "", done->report,
                           cli::sectionsOf(done->job, done->result));
  });
}

} // namespace

void addVoxelize(nb::module_& module) {
  module.def("voxelize", &voxelizeInputs, nb::arg("inputs"), nb::arg("settings"),
             "Internal: tetvdb.voxelize() with its inputs told apart.");
}

} // namespace tetvdb::python
