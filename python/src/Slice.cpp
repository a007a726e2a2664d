// SPDX-License-Identifier: Apache-2.0
#include "Functions.h"
#include "Inputs.h"
#include "JobReport.h"
#include "MeshArrays.h"
#include "Report.h"
#include "Settings.h"
#include "tetvdb/pipeline/SliceJob.h"

#include <memory>
#include <nanobind/stl/string.h>
#include <utility>

namespace tetvdb::python {
namespace {

void takePrinter(Settings& settings, PrinterSettings& printer) {
  if (settings.has("printer"))
    printer = readPrinter(pathOf(settings.get("printer")));
  std::vector<double> pair;
  settings.takePair("pixels", pair);
  for (std::size_t k = 0; k < pair.size(); ++k) {
    if (!(pair[k] >= 1 && pair[k] <= 1 << 20) || pair[k] != static_cast<int>(pair[k]))
      Settings::refuse("pixels", "cannot be used", "give two whole numbers, such as (2560, 1440)");
    printer.pixels[k] = static_cast<int>(pair[k]);
  }
  pair.clear();
  settings.takePair("display", pair);
  if (!pair.empty())
    printer.display = {pair[0], pair[1]};
  if (settings.has("layer_height")) {
    settings.takeLength("layer_height", printer.layerHeight);
    printer.firstLayerHeight = 0;
  }
  settings.takeLength("first_layer_height", printer.firstLayerHeight);
}

// A number of zero or more.
void takeNumber(Settings& settings, const char* name, double& value) {
  settings.take(name, value);
  if (settings.has(name) && value < 0)
    Settings::refuse(name, "is below 0", "give a number, zero or more");
}

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

SliceJob jobOf(Settings& settings) {
  SliceJob job;
  takePrinter(settings, job.printer);
  takeExposure(settings, job.printer);
  settings.take("grid", job.grid);
  settings.take("format", job.format);
  settings.take("units", job.units);
  settings.takeLength("scale", job.place.scale);
  if (nb::isinstance<nb::str>(settings.get("place")) || !settings.has("place")) {
    std::string place = "centre";
    settings.take("place", place);
    job.place.keep = place == "keep";
    if (place != "keep" && place != "centre" && place != "center")
      Settings::refuse("place", "'" + place + "' is no place", "give centre, keep or (x, y)");
  } else {
    std::vector<double> pair;
    settings.takePair("place", pair);
    job.place.centre = {pair[0], pair[1]};
  }
  settings.takeWord("aa",
                    {{"volume", SliceAa::Volume}, {"area", SliceAa::Area}, {"none", SliceAa::None}},
                    job.aa);
  settings.take("levels", job.grey.levels);
  job.grey.gamma = job.printer.gamma;
  settings.take("gamma", job.grey.gamma);
  settings.take("dither", job.dither);
  settings.take("materials", job.materials);
  settings.takeCleaning(job.clean);
  if (settings.has("output"))
    job.output = pathOf(settings.get("output"));
  job.keep = job.output.empty();
  return job;
}

nb::tuple sliceInputs(const nb::list& given, const nb::dict& keywords) {
  Settings settings(keywords);
  SliceJob job = jobOf(settings);
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
