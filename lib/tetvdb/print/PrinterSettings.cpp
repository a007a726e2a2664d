// SPDX-License-Identifier: Apache-2.0
//
// Keys: PrusaSlicer's print configuration for SLA, as written to .ini and .sl1 files.
#include "tetvdb/print/PrinterSettings.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/source/Source.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string_view>

namespace tetvdb {
namespace {

constexpr int kMaxPixels = 1 << 20;

// One value of a file, and its line.
struct Entry {
  std::string_view value;
  const std::string& where;

  [[noreturn]] void fail(const char* what) const {
    throw Error(Status::Invalid, where, "'" + std::string(value) + "' is " + what);
  }
  double number() const {
    double result = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), result);
    if (error != std::errc() || end != value.data() + value.size() || !std::isfinite(result))
      fail("not a number");
    return result;
  }
  double positive() const {
    const double result = number();
    if (!(result > 0))
      fail("not above zero");
    return result;
  }
  double notNegative() const {
    const double result = number();
    if (!(result >= 0))
      fail("below zero");
    return result;
  }
  int count() const {
    const double result = notNegative();
    if (result != std::floor(result) || result > kMaxPixels)
      fail("not a whole number that can be used");
    return static_cast<int>(result);
  }
  bool flag() const {
    if (value != "0" && value != "1")
      fail("neither 0 nor 1");
    return value == "1";
  }
  bool isPortrait() const {
    if (value != "portrait" && value != "landscape")
      fail("neither portrait nor landscape");
    return value == "portrait";
  }
};

using Setter = std::function<void(PrinterSettings&, const Entry&)>;

const std::map<std::string_view, Setter>& setters() {
  using P = PrinterSettings;
  static const std::map<std::string_view, Setter> all = {
      {"display_pixels_x", [](P& p, const Entry& e) { p.pixels[0] = e.count(); }},
      {"display_pixels_y", [](P& p, const Entry& e) { p.pixels[1] = e.count(); }},
      {"display_width", [](P& p, const Entry& e) { p.display[0] = e.positive(); }},
      {"display_height", [](P& p, const Entry& e) { p.display[1] = e.positive(); }},
      {"display_orientation", [](P& p, const Entry& e) { p.portrait = e.isPortrait(); }},
      {"display_mirror_x", [](P& p, const Entry& e) { p.mirror[0] = e.flag(); }},
      {"display_mirror_y", [](P& p, const Entry& e) { p.mirror[1] = e.flag(); }},
      {"max_print_height", [](P& p, const Entry& e) { p.maxHeight = e.notNegative(); }},
      {"layer_height", [](P& p, const Entry& e) { p.layerHeight = e.positive(); }},
      {"initial_layer_height", [](P& p, const Entry& e) { p.firstLayerHeight = e.positive(); }},
      {"exposure_time", [](P& p, const Entry& e) { p.exposure = e.notNegative(); }},
      {"initial_exposure_time", [](P& p, const Entry& e) { p.firstExposure = e.notNegative(); }},
      {"faded_layers", [](P& p, const Entry& e) { p.fadedLayers = e.count(); }},
      {"bottom_layers", [](P& p, const Entry& e) { p.bottomLayers = e.count(); }},
      {"gamma_correction", [](P& p, const Entry& e) { p.gamma = e.notNegative(); }},
      {"relative_correction_x", [](P& p, const Entry& e) { p.stretch[0] *= e.positive(); }},
      {"relative_correction_y", [](P& p, const Entry& e) { p.stretch[1] *= e.positive(); }},
      {"relative_correction_z", [](P& p, const Entry& e) { p.stretch[2] *= e.positive(); }},
      {"material_correction_x", [](P& p, const Entry& e) { p.stretch[0] *= e.positive(); }},
      {"material_correction_y", [](P& p, const Entry& e) { p.stretch[1] *= e.positive(); }},
      {"material_correction_z", [](P& p, const Entry& e) { p.stretch[2] *= e.positive(); }},
      {"absolute_correction", [](P& p, const Entry& e) { p.xyOffset = e.number(); }},
      {"elefant_foot_compensation", [](P& p, const Entry& e) { p.footOffset = e.notNegative(); }},
      {"lift_height", [](P& p, const Entry& e) { p.liftHeight = e.notNegative(); }},
      {"lift_speed", [](P& p, const Entry& e) { p.liftSpeed = e.notNegative(); }},
      {"retract_speed", [](P& p, const Entry& e) { p.retractSpeed = e.notNegative(); }},
      {"bottom_lift_height", [](P& p, const Entry& e) { p.bottomLiftHeight = e.notNegative(); }},
      {"bottom_lift_speed", [](P& p, const Entry& e) { p.bottomLiftSpeed = e.notNegative(); }},
      {"light_off_delay", [](P& p, const Entry& e) { p.lightOffDelay = e.notNegative(); }}};
  return all;
}

} // namespace

double PrinterSettings::exposureOf(int k) const {
  if (firstExposure <= 0 || k < bottomLayers)
    return firstExposure > 0 ? firstExposure : exposure;
  const int step = k - bottomLayers + 1;
  if (step > fadedLayers)
    return exposure;
  return firstExposure + (exposure - firstExposure) * step / (fadedLayers + 1);
}

PrinterSettings readPrinter(const std::string& path) {
  const MappedFile file(path);
  PrinterSettings printer;
  std::string_view left = file.bytes();
  for (std::size_t number = 1; !left.empty(); ++number) {
    const std::size_t end = std::min(left.find('\n'), left.size());
    const std::string_view line = trimmed(left.substr(0, end));
    left.remove_prefix(std::min(end + 1, left.size()));
    if (line.empty() || line.front() == '#' || line.front() == ';')
      continue;
    const std::string where = path + ":" + std::to_string(number);
    if (line.front() == '[')
      throw Error(Status::Invalid, where, "has sections, possibly of several printers",
                  "export the configuration of a single printer");
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos)
      throw Error(Status::Invalid, where, "is not a line 'key = value'");
    const std::string_view key = trimmed(line.substr(0, equals));
    const std::string_view value = trimmed(line.substr(equals + 1));
    if (!printer.keys.emplace(key, value).second)
      throw Error(Status::Invalid, where, "'" + std::string(key) + "' is repeated");
    const auto setter = setters().find(key);
    if (setter != setters().end())
      setter->second(printer, Entry{value, where});
  }
  return printer;
}

void checkPrinter(const PrinterSettings& printer) {
  for (const int count : printer.pixels)
    if (count < 1 || count > kMaxPixels)
      throw Error(Status::Usage, "`pixels`", "the display's pixels are not known",
                  "give `pixels=W,H`, or a file with them by `printer`");
  for (const double side : printer.display)
    if (!(side > 0) || !std::isfinite(side))
      throw Error(Status::Usage, "`display`", "the display's size is not known",
                  "give `display=W,H` in millimetres, or a file with it by `printer`");
  if (!(printer.layerHeight > 0) || !std::isfinite(printer.layerHeight))
    throw Error(Status::Usage, "`layer_height`", "the height of a layer is not known",
                "give it in millimetres");
}

} // namespace tetvdb
