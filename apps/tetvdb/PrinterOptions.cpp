// SPDX-License-Identifier: Apache-2.0
#include "PrinterOptions.h"

#include "Commands.h"
#include "ParseQuantities.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/pipeline/MeshObjects.h"

#include <array>
#include <cmath>
#include <vector>

namespace tetvdb::cli {
namespace {

std::array<double, 2> parsePair(const std::string& option, const std::string& text) {
  const std::vector<double> numbers = parseNumbers(option, text);
  if (numbers.size() != 2 || !std::isfinite(numbers[0]) || !std::isfinite(numbers[1]))
    throw Error(Status::Usage, option, "'" + text + "' cannot be used",
                "give two numbers with a comma between them");
  return {numbers[0], numbers[1]};
}

} // namespace

void takeNumber(const std::string& option, const std::string& text, double& value) {
  if (text.empty())
    return;
  const std::vector<double> numbers = parseNumbers(option, text);
  if (numbers.size() != 1 || !(numbers[0] >= 0) || !std::isfinite(numbers[0]))
    throw Error(Status::Usage, option, "'" + text + "' cannot be used",
                "give a number, zero or more");
  value = numbers[0];
}

void addPrinterOptions(CLI::App& command, PrinterOptions& options) {
  const auto add = [&](const char* name, std::string& value, const char* type,
                       const std::string& description) {
    return command.add_option(name, value, description)->type_name(type)->check(notEmpty());
  };
  add("--printer", options.printer, "FILE",
      "The printer's settings: keys of PrusaSlicer, one a line; options below replace them");
  add("--pixels", options.pixels, "W,H", "Pixels of the display");
  add("--display", options.display, "W,H", "Size of the display, mm");
  add("--layer-height", options.layerHeight, "H", "Height of a layer, mm");
  add("--first-layer-height", options.firstLayerHeight, "H", "Of the first (default: as others)");
  add("--orientation", options.orientation, "O",
      "landscape, or portrait: images are turned by a quarter")
      ->check(CLI::IsMember({"landscape", "portrait"}).description(""));
  add("--mirror", options.mirror, "AXES", "Mirror images along x, y, xy or none")
      ->check(CLI::IsMember({"x", "y", "xy", "none"}).description(""));
  add("--max-height", options.maxHeight, "H", "Largest height of a model, mm (0: no limit)");
}

void addModelOptions(CLI::App& command, PrinterOptions& options) {
  command
      .add_option("--place", options.place,
                  "centre: the centre of the display (default); X,Y: the box's centre there, mm; "
                  "keep: coordinates are the plate's")
      ->type_name("PLACE")
      ->check(notEmpty());
  command.add_option("--units", options.units, "Of the model: um, mm, cm, m, in or ft")
      ->type_name("UNIT")
      ->check(notEmpty());
  command.add_option("--scale", options.scale, "Multiply the model by F")->type_name("F");
  command
      .add_option("--stretch", options.stretch,
                  "Multiply it along each axis, against shrinkage of the material")
      ->type_name("FX,FY,FZ")
      ->check(notEmpty());
  command
      .add_option("--xy-offset", options.xyOffset,
                  "Grow outlines by D mm, below 0: shrink them, against light that spreads")
      ->type_name("D");
  command
      .add_option("--foot-offset", options.footOffset,
                  "Shrink the first layer's outline by D mm, those of the transition layers less")
      ->type_name("D");
  command.add_option("--grid", options.grid, "Of a volume, by name")
      ->type_name("NAME")
      ->check(notEmpty());
}

PrinterSettings printerFrom(const PrinterOptions& options) {
  PrinterSettings printer;
  if (!options.printer.empty())
    printer = readPrinter(options.printer);
  if (!options.pixels.empty()) {
    const auto pixels = parsePair("--pixels", options.pixels);
    for (std::size_t k = 0; k < 2; ++k) {
      if (!(pixels[k] >= 1 && pixels[k] <= 1 << 20) || pixels[k] != std::floor(pixels[k]))
        throw Error(Status::Usage, "--pixels", "'" + options.pixels + "' cannot be used",
                    "give two whole numbers, such as 2560,1440");
      printer.pixels[k] = static_cast<int>(pixels[k]);
    }
  }
  if (!options.display.empty())
    printer.display = parsePair("--display", options.display);
  if (!options.layerHeight.empty()) {
    printer.layerHeight = parseLength("--layer-height", options.layerHeight);
    printer.firstLayerHeight = 0;
  }
  if (!options.firstLayerHeight.empty())
    printer.firstLayerHeight = parseLength("--first-layer-height", options.firstLayerHeight);
  if (!options.orientation.empty())
    printer.portrait = options.orientation == "portrait";
  if (!options.mirror.empty())
    printer.mirror = {options.mirror == "x" || options.mirror == "xy",
                      options.mirror == "y" || options.mirror == "xy"};
  takeNumber("--max-height", options.maxHeight, printer.maxHeight);
  if (!options.xyOffset.empty()) {
    const std::vector<double> numbers = parseNumbers("--xy-offset", options.xyOffset);
    if (numbers.size() != 1 || !std::isfinite(numbers[0]))
      throw Error(Status::Usage, "--xy-offset", "'" + options.xyOffset + "' is not a length");
    printer.xyOffset = numbers[0];
  }
  takeNumber("--foot-offset", options.footOffset, printer.footOffset);
  if (!options.stretch.empty()) {
    const Vec3d factors = parsePoint("--stretch", options.stretch);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(factors[k] > 0))
        throw Error(Status::Usage, "--stretch", "factors must be above zero");
      printer.stretch[k] *= factors[k];
    }
  }
  return printer;
}

PlaceOptions placeFrom(const PrinterOptions& options) {
  PlaceOptions place;
  if (!std::isfinite(options.scale) || !(options.scale > 0))
    throw Error(Status::Usage, "--scale", "must be a number above zero");
  place.scale = options.scale;
  if (options.place == "keep")
    place.keep = true;
  else if (!options.place.empty() && options.place != "centre" && options.place != "center")
    place.centre = parsePair("--place", options.place);
  return place;
}

SliceJob sliceJobFrom(const PrinterOptions& options, const std::vector<std::string>& inputs) {
  SliceJob job;
  job.inputs = inputs;
  for (const std::string& input : inputs) {
    const MappedFile readable(input); // says so at once if the file is not there
    job.isVolume = job.isVolume || isVolumeFile(input);
  }
  job.grid = options.grid;
  if (!job.grid.empty() && !job.isVolume)
    throw Error(Status::Usage, "--grid", "chooses a grid of a volume; the input is a mesh",
                "leave it out");
  job.printer = printerFrom(options);
  job.place = placeFrom(options);
  job.units = options.units;
  if (!options.units.empty() && !(metresOf(options.units) > 0))
    throw Error(Status::Usage, "--units", "'" + options.units + "' is not a known unit",
                "choose from um, mm, cm, m, in and ft");
  return job;
}

} // namespace tetvdb::cli
