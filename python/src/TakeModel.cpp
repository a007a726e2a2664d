// SPDX-License-Identifier: Apache-2.0
#include "TakeModel.h"

#include "Report.h"

#include <nanobind/stl/string.h>

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

} // namespace

void takeModel(Settings& settings, SliceJob& job) {
  takePrinter(settings, job.printer);
  settings.take("grid", job.grid);
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
  settings.takeCleaning(job.clean);
}

void takeNumber(Settings& settings, const char* name, double& value) {
  settings.take(name, value);
  if (settings.has(name) && value < 0)
    Settings::refuse(name, "is below 0", "give a number, zero or more");
}

} // namespace tetvdb::python
