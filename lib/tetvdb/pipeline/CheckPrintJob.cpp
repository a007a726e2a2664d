// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/CheckPrintJob.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/InArena.h"
#include "tetvdb/pipeline/OpenLayers.h"
#include "tetvdb/pipeline/PrintPicture.h"
#include "tetvdb/print/CheckLayers.h"
#include "tetvdb/print/PlateMap.h"
#include "tetvdb/visualize/WritePng.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <string_view>
#include <utility>

namespace tetvdb {
namespace {

// Fine enough to resolve overhangs within several degrees: half a pixel's diagonal is the
// tolerance.
struct PixelSize {
  double pixel, layer;
};

PixelSize pixelSizeFor(PrintTarget target) {
  switch (target) {
  case PrintTarget::Lpbf:
    return {0.015, 0.03};
  case PrintTarget::Fdm:
    return {0.05, 0.2};
  case PrintTarget::Sla:
    break;
  }
  return {0.025, 0.05};
}

void setPixels(PrinterSettings& printer, std::size_t axis, double count, double pixel) {
  constexpr double kMaxPixels = 1 << 20;
  if (!(count <= kMaxPixels))
    throw Error(Status::Limit, "",
                fmt::format("the model is more than 2^20 pixels of {:.4g} mm wide", pixel),
                "scale it with `scale`, or check `units`");
  printer.pixels[axis] = static_cast<int>(count);
  printer.display[axis] = count * pixel;
}

// Removes a number from the front of `text` and returns it.
double takeNumber(std::string_view& text, const char* key) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || !std::isfinite(number))
    throw Error(Status::Invalid, key, "'" + std::string(text) + "' is not a number");
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

// Parses "0x0,250x0,250x210,0x210".
std::array<double, 2> sizeOfBed(std::string_view shape) {
  constexpr const char* kKey = "bed_shape";
  std::array<double, 2> low{}, high{};
  for (bool first = true; first || !shape.empty(); first = false) {
    if (!first)
      shape.remove_prefix(1); // a comma
    std::array<double, 2> corner{};
    corner[0] = takeNumber(shape, kKey);
    if (shape.empty() || shape.front() != 'x')
      throw Error(Status::Invalid, kKey, "has a corner that is not XxY");
    shape.remove_prefix(1);
    corner[1] = takeNumber(shape, kKey);
    if (!shape.empty() && shape.front() != ',')
      throw Error(Status::Invalid, kKey, "has a corner that is not XxY");
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = first ? corner[k] : std::min(low[k], corner[k]);
      high[k] = first ? corner[k] : std::max(high[k], corner[k]);
    }
  }
  if (!(high[0] > low[0]) || !(high[1] > low[1]))
    throw Error(Status::Invalid, kKey, "has no area");
  return {high[0] - low[0], high[1] - low[1]};
}

// Millimetres, or "80%" of the others' height.
double firstLayerOf(std::string_view text, double layerHeight) {
  const double number = takeNumber(text, "first_layer_height");
  const double height = text == "%" ? number / 100 * layerHeight : number;
  if ((!text.empty() && text != "%") || !(height > 0))
    throw Error(Status::Invalid, "first_layer_height", "is not a height");
  return height;
}

class PrintChecking {
public:
  PrintChecking(const CheckPrintJob& job, Report& report, Progress& progress)
      : job_(job), report_(report), progress_(progress) {}

  CheckPrintResult run() {
    if (!job_.picture.empty()) {
      requireSeparateFiles(job_.slice.inputs, {job_.picture});
      requireWritable(job_.picture);
    }
    SliceJob slice = job_.slice;
    slice.grey = {};
    slice.grey.levels = 2;
    slice.materials = slice.dither = false;
    OpenOptions options;
    options.keepMesh = !job_.picture.empty();
    options.fit = [&](const WorldBox& box, PrinterSettings& printer, PlaceOptions& place) {
      fit(box, printer, place);
    };
    OpenedLayers opened = openLayers(slice, options, report_, progress_);
    if (!job_.picture.empty() && opened.mesh.triangles.empty())
      throw Error(Status::Usage, "`picture`", "voxels that match the printer's have no surface",
                  "leave it out, or draw the volume with render");
    result_.slice = std::move(opened.result);
    warnOfSize();
    result_.slice.frame = opened.source->frame();
    look(opened);
    return std::move(result_);
  }

private:
  // Enlarges the plate to the model if necessary.
  void fit(WorldBox box, PrinterSettings& printer, PlaceOptions& place) {
    if (!job_.plateKnown) {
      constexpr double kRoom = 1; // millimetres around it
      for (std::size_t k = 0; k < 2; ++k) {
        const double pixel = printer.display[k] / printer.pixels[k];
        const double side = box.max[k] - box.min[k];
        setPixels(printer, k, std::ceil((side + 2 * kRoom) / pixel), pixel);
        box.min[k] = (printer.display[k] - side) / 2;
        box.max[k] = box.min[k] + side;
      }
    }
    result_.printer = printer;
    for (std::size_t k = 0; k < 3; ++k) {
      const double length = k < 2 ? printer.display[k] : printer.maxHeight;
      const double slack = kPlateRounding * std::max(length, box.max[k] - box.min[k]);
      if (box.min[k] < -slack)
        result_.beyond[k][0] = -box.min[k];
      if ((k < 2 || length > 0) && box.max[k] > length + slack)
        result_.beyond[k][1] = box.max[k] - length;
    }
    // Adds equally many pixels on both sides, so that rotations and mirroring are preserved.
    std::array<double, 2> centre{};
    for (std::size_t k = 0; k < 2; ++k) {
      const double pixel = printer.display[k] / printer.pixels[k];
      const double beyond = std::max(result_.beyond[k][0], result_.beyond[k][1]);
      marginPixels_[k] = beyond > 0 ? std::ceil(beyond / pixel) + 1 : 0;
      margin_[k] = marginPixels_[k] * pixel;
      if (beyond > 0)
        setPixels(printer, k, printer.pixels[k] + 2 * marginPixels_[k], pixel);
      centre[k] = (box.min[k] + box.max[k]) / 2 + margin_[k];
    }
    printer.maxHeight = 0;
    if (margin_[0] == 0 && margin_[1] == 0 && result_.beyond[2][0] == 0)
      return;
    place.keep = false;
    place.centre = centre;
  }

  void warnOfSize() {
    constexpr double kSmall = 1; // millimetres
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k)
      longest = std::max(longest, result_.slice.box.max[k] - result_.slice.box.min[k]);
    if (longest < kSmall)
      report_.warn("size", fmt::format("the model is {:.3g} mm long; if its unit is not the "
                                       "millimetre, give `units`",
                                       longest));
  }

  void look(OpenedLayers& opened) {
    {
      StageTimer timer(report_, "check");
      progress_.stage("check");
      result_.checks = checkLayers(*opened.source, job_.limits, progress_);
    }
    result_.limits = job_.limits;
    result_.slice.volume = result_.checks.volume;
    result_.slice.emptyLayers = static_cast<std::size_t>(result_.checks.emptyLayers);
    opened.source.reset();
    placeFindings(opened);
    addOutside(opened);
    if (job_.picture.empty())
      return;
    StageTimer timer(report_, "picture");
    progress_.stage("picture");
    writePng(job_.picture, printPicture(std::move(opened.mesh), result_, progress_));
  }

  // Maps pixels, in millimetres on the enlarged plate, to the input's coordinates.
  static Vec3d modelOf(const OpenedLayers& opened, double column, double row, double z) {
    const auto [x, y] = plateOf(opened.printer, column, row);
    const Vec3d plate{x, y, z};
    Vec3d model;
    for (std::size_t k = 0; k < 3; ++k)
      model[k] = (plate[k] - opened.map.offset[k]) / opened.map.scale[k];
    return model;
  }

  void placeFindings(const OpenedLayers& opened) {
    const LayerFrame& frame = result_.slice.frame;
    const std::size_t across = opened.printer.portrait ? 1 : 0;
    const double columns = marginPixels_[across], rows = marginPixels_[1 - across];
    for (PrintFinding& finding : result_.checks.findings) {
      PrintPlace place;
      const double z = frame.bottomOf(finding.layer) + frame.heightOf(finding.layer) / 2;
      place.model = modelOf(opened, finding.pixel[0], finding.pixel[1], z);
      const auto [x, y] = plateOf(opened.printer, finding.pixel[0], finding.pixel[1]);
      place.plate = {x - margin_[0], y - margin_[1], z};
      if (finding.fault == PrintFault::EmptyLayer)
        finding.box = {0, 0, frame.width - 1, frame.height - 1};
      const Vec3d a =
          modelOf(opened, finding.box.minX, finding.box.minY, frame.bottomOf(finding.first));
      const Vec3d b = modelOf(opened, finding.box.maxX + 1.0, finding.box.maxY + 1.0,
                              frame.bottomOf(finding.last + 1));
      for (std::size_t k = 0; k < 3; ++k) {
        place.low[k] = std::min(a[k], b[k]);
        place.high[k] = std::max(a[k], b[k]);
      }
      result_.places.push_back(place);
      finding.pixel[0] -= columns;
      finding.pixel[1] -= rows;
      finding.box.minX -= static_cast<std::int32_t>(columns);
      finding.box.maxX -= static_cast<std::int32_t>(columns);
      finding.box.minY -= static_cast<std::int32_t>(rows);
      finding.box.maxY -= static_cast<std::int32_t>(rows);
    }
    for (std::size_t k = 0; k < 2; ++k) {
      result_.slice.box.min[k] -= margin_[k];
      result_.slice.box.max[k] -= margin_[k];
    }
  }

  void addOutside(const OpenedLayers& opened) {
    bool any = false;
    for (const auto& sides : result_.beyond)
      any = any || sides[0] > 0 || sides[1] > 0;
    if (!any || !job_.outside)
      return;
    const WorldBox& box = result_.slice.box;
    PrintFinding finding;
    finding.fault = PrintFault::Outside;
    finding.last = result_.slice.frame.layers - 1;
    finding.height = box.max[2];
    PrintPlace place;
    for (std::size_t k = 0; k < 3; ++k) {
      place.plate[k] = (box.min[k] + box.max[k]) / 2;
      place.model[k] =
          (place.plate[k] + (k < 2 ? margin_[k] : 0) - opened.map.offset[k]) / opened.map.scale[k];
    }
    result_.checks.findings.insert(result_.checks.findings.begin(), finding);
    result_.places.insert(result_.places.begin(), place);
  }

  const CheckPrintJob& job_;
  Report& report_;
  Progress& progress_;
  CheckPrintResult result_;
  std::array<double, 2> margin_{}, marginPixels_{}; ///< enlargement of the plate
};

} // namespace

PrintLimits limitsFor(PrintTarget target) {
  PrintLimits limits;
  limits.minArea = 0.1;
  limits.minVolume = 0.1;
  switch (target) {
  case PrintTarget::Sla:
    limits.overhangAngle = 60;
    limits.minWall = 0.5;
    limits.minGap = 0.3;
    limits.drain = 3.5;
    break;
  case PrintTarget::Lpbf:
    limits.cups = false;
    limits.overhangAngle = 45;
    limits.minWall = 0.4;
    limits.minGap = 0.2;
    limits.drain = 2;
    break;
  case PrintTarget::Fdm:
    limits.cups = limits.traps = false;
    limits.overhangAngle = 45;
    limits.minWall = 0.8;
    limits.minGap = 0.4;
    break;
  }
  limits.minFloor = limits.minWall;
  return limits;
}

bool completePrinter(PrintTarget target, PrinterSettings& printer) {
  const PixelSize size = pixelSizeFor(target);
  if (!(printer.layerHeight > 0))
    printer.layerHeight = size.layer;
  if (printer.pixels[0] != 0 || printer.pixels[1] != 0 || printer.display[0] != 0 ||
      printer.display[1] != 0)
    return true;
  const auto bed = printer.keys.find("bed_shape"), first = printer.keys.find("first_layer_height");
  const bool known = bed != printer.keys.end();
  const std::array<double, 2> plate = known ? sizeOfBed(bed->second) : std::array<double, 2>{};
  for (std::size_t k = 0; k < 2; ++k)
    setPixels(printer, k, known ? std::round(plate[k] / size.pixel) : 1000, size.pixel);
  if (known && first != printer.keys.end() && printer.firstLayerHeight == 0)
    printer.firstLayerHeight = firstLayerOf(first->second, printer.layerHeight);
  return known;
}

CheckPrintResult run(const CheckPrintJob& job, Report& report, Progress& progress) {
  return inArena(job.slice.threads, [&] { return PrintChecking(job, report, progress).run(); });
}

} // namespace tetvdb
