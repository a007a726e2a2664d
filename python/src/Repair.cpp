// SPDX-License-Identifier: Apache-2.0
#include "Functions.h"
#include "Inputs.h"
#include "KeptResult.h"
#include "Meshes.h"
#include "Settings.h"
#include "tetvdb/pipeline/RepairJob.h"

#include <nanobind/stl/string.h>
#include <utility>

namespace tetvdb::python {
namespace {

RepairJob repairJobOf(Settings& settings) {
  RepairJob job;
  job.keep = true;
  settings.take("grid", job.grid);
  settings.takeSize(job.voxelSize, job.resolution);
  settings.take("simplify", job.simplify);
  if (job.simplify < 0)
    Settings::refuse("simplify", "is below 0", "give a number of voxels, zero or more");
  settings.take("remesh", job.remesh);
  int faces = 0;
  settings.take("faces", faces);
  if (settings.has("faces") && faces < 4)
    Settings::refuse("faces", "is too small", "give 4 or more: a closed surface has no fewer");
  job.finish.faces = static_cast<std::size_t>(faces);
  settings.takeRelative("error", job.finish.error, false);
  settings.takeRelative("smooth", job.finish.smooth, false);
  settings.takeLength("scale", job.scale);
  settings.take("units", job.units);
  settings.takeInside(job.solid);
  settings.takeCleaning(job.clean);
  return job;
}

nb::object repairInputs(const nb::list& given, const nb::dict& keywords) {
  Settings settings(keywords);
  RepairJob job = repairJobOf(settings);
  const JobLimits limits = settings.finish(job);
  Inputs inputs = inputsOf(given);
  job.isVolume = isVolume(inputs.names.front(), inputs.memory);
  job.input = inputs.names.front();
  job.more.assign(inputs.names.begin() + 1, inputs.names.end());
  job.memory = std::move(inputs.memory);
  return keptResult("repair", std::move(job), limits, [](TriangleMesh mesh, ReportText report) {
    return meshObject(std::move(mesh), std::move(report));
  });
}

} // namespace

void addRepair(nb::module_& module) {
  module.def("repair", &repairInputs, nb::arg("inputs"), nb::arg("settings"),
             "Internal: tetvdb.repair() with its inputs told apart.");
}

} // namespace tetvdb::python
