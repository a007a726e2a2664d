// SPDX-License-Identifier: Apache-2.0
#include "Functions.h"
#include "Inputs.h"
#include "JobReport.h"
#include "MeshArrays.h"
#include "Report.h"
#include "Settings.h"
#include "TakeModel.h"
#include "tetvdb/pipeline/SliceJob.h"

#include <memory>
#include <nanobind/stl/string.h>
#include <utility>

namespace tetvdb::python {
namespace {

void takeLayers(Settings& settings, const char* name, int& value) {
  std::uint64_t count = 0;
  settings.takeWhole(name, 0, 1 << 20, count);
  if (settings.has(name))
    value = static_cast<int>(count);
}

void takeExposure(Settings& settings, PrinterSettings& printer) {
  takeNumber(settings, "exposure", printer.exposure);
  takeNumber(settings, "bottom_exposure", printer.firstExposure);
  takeLayers(settings, "bottom_layers", printer.bottomLayers);
  takeLayers(settings, "transition_layers", printer.fadedLayers);
  takeNumber(settings, "lift_height", printer.liftHeight);
  if (settings.has("lift_height"))
    printer.bottomLiftHeight = printer.liftHeight;
  takeNumber(settings, "lift_speed", printer.liftSpeed);
  if (settings.has("lift_speed"))
    printer.bottomLiftSpeed = printer.liftSpeed;
  takeNumber(settings, "retract_speed", printer.retractSpeed);
  takeNumber(settings, "light_off_delay", printer.lightOffDelay);
}

SliceJob sliceJobOf(Settings& settings) {
  SliceJob job;
  takeModel(settings, job);
  takeExposure(settings, job.printer);
  settings.take("format", job.format);
  settings.takeWord("aa",
                    {{"volume", SliceAa::Volume}, {"area", SliceAa::Area}, {"none", SliceAa::None}},
                    job.aa);
  settings.take("levels", job.grey.levels);
  job.grey.gamma = job.printer.gamma;
  settings.take("gamma", job.grey.gamma);
  settings.take("dither", job.dither);
  settings.take("materials", job.materials);
  if (settings.has("output"))
    job.output = pathOf(settings.get("output"));
  job.keep = job.output.empty();
  return job;
}

nb::tuple sliceInputs(const nb::list& given, const nb::dict& keywords) {
  Settings settings(keywords);
  SliceJob job = sliceJobOf(settings);
  const JobLimits limits = settings.finish(job);
  Inputs inputs = inputsOf(given);
  job.isVolume = isVolume(inputs.names.front(), inputs.memory);
  job.inputs = std::move(inputs.names);
  job.memory = std::move(inputs.memory);
  JobRun work(limits);
  SliceResult result =
      work([&](Report& report, Progress& progress) { return run(job, report, progress); });
  nb::object layers = nb::none();
  if (job.keep) {
    const std::vector<std::size_t> shape{static_cast<std::size_t>(result.frame.layers),
                                         static_cast<std::size_t>(result.frame.height),
                                         static_cast<std::size_t>(result.frame.width)};
    layers = arrayObject(std::move(result.kept), shape, nb::dtype<std::uint8_t>());
  }
  const std::string text = cli::reportText("slice", statusOf(work.report()), "", work.report(),
                                           cli::sectionsOf(job, result));
  return nb::make_tuple(layers, reportDict([&] { return text; }));
}

} // namespace

void addSlice(nb::module_& module) {
  module.def("slice", &sliceInputs, nb::arg("inputs"), nb::arg("settings"),
             "Internal: tetvdb.slice() with its inputs told apart.");
}

} // namespace tetvdb::python
