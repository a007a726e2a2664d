// SPDX-License-Identifier: Apache-2.0
#include "Functions.h"
#include "Inputs.h"
#include "KeptResult.h"
#include "Meshes.h"
#include "Settings.h"
#include "tetvdb/pipeline/TetrahedralizeJob.h"

#include <nanobind/stl/string.h>
#include <utility>

namespace tetvdb::python {
namespace {

TetrahedralizeJob jobOf(Settings& settings, std::size_t inputs) {
  TetrahedralizeJob job;
  job.keep = true;
  settings.takeCleaning(job.clean);
  settings.takeRelative("epsilon", job.epsilon, false);
  settings.takeRelative("edge_length", job.edgeLength, false);
  settings.take("stop_energy", job.mesher.stopEnergy);
  // The regular tet has 3, so that less can never be reached.
  if (settings.has("stop_energy") && job.mesher.stopEnergy <= 3)
    Settings::refuse("stop_energy", "cannot be reached",
                     "give a number above 3, the energy of a regular tet; 10 is a good mesh");
  settings.take("max_passes", job.mesher.maxPasses);
  if (job.mesher.maxPasses < 0)
    Settings::refuse("max_passes", "is below 0", "give 0 or more");
  settings.takeWord("boolean",
                    {{"union", Boolean::Union},
                     {"difference", Boolean::Difference},
                     {"intersection", Boolean::Intersection}},
                    job.mesher.boolean);
  if (job.mesher.boolean != Boolean::Materials && inputs < 2)
    Settings::refuse("boolean", "takes two inputs or more", "give another one");
  settings.take("keep_outside", job.mesher.keepOutside);
  return job;
}

nb::object tetrahedralizeInputs(const nb::list& given, const nb::dict& keywords) {
  Settings settings(keywords);
  TetrahedralizeJob job = jobOf(settings, given.size());
  const JobLimits limits = settings.finish(job);
  Inputs inputs = inputsOf(given);
  job.inputs = std::move(inputs.names);
  job.memory = std::move(inputs.memory);
  return keptResult("tetrahedralize", std::move(job), limits, [](TetMesh mesh, ReportText report) {
    return meshObject(std::move(mesh), std::move(report));
  });
}

} // namespace

void addTetrahedralize(nb::module_& module) {
  module.def("tetrahedralize", &tetrahedralizeInputs, nb::arg("inputs"), nb::arg("settings"),
             "Internal: tetvdb.tetrahedralize() with its inputs told apart.");
}

} // namespace tetvdb::python
