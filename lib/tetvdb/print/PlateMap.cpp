// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/PlateMap.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr double kMaxLayers = 1 << 20;

} // namespace

PlateMap mapToPlate(const WorldBox& model, const PrinterSettings& printer,
                    const PlaceOptions& options) {
  if (!model.finite || !(model.min[0] <= model.max[0]))
    throw Error(Status::Invalid, "", "the model has no box: coordinates that are not finite");
  if (!(options.scale > 0) || !std::isfinite(options.scale))
    throw Error(Status::Usage, "`scale`", "must be a number above zero");
  PlateMap map;
  for (std::size_t k = 0; k < 3; ++k) {
    map.scale[k] = options.scale * printer.stretch[k];
    double low = model.min[k] * map.scale[k];
    const double high = model.max[k] * map.scale[k];
    if (!options.keep && k < 2) {
      const double centre = options.centre ? (*options.centre)[k] : printer.display[k] / 2;
      map.offset[k] = centre - (low + high) / 2;
    } else if (!options.keep) {
      map.offset[k] = -low;
    }
    map.box.min[k] = low + map.offset[k];
    map.box.max[k] = high + map.offset[k];
  }
  return map;
}

PlateMap placeOnPlate(const WorldBox& model, const PrinterSettings& printer,
                      const PlaceOptions& options) {
  const PlateMap map = mapToPlate(model, printer, options);
  const auto side = [&](std::size_t k) { return map.box.max[k] - map.box.min[k]; };
  for (std::size_t k = 0; k < 2; ++k) {
    const double slack = kPlateRounding * printer.display[k];
    if (side(k) > printer.display[k] + slack)
      throw Error(Status::Limit, "",
                  fmt::format("the model is {:.6g} x {:.6g} x {:.6g} mm, the display {:.6g} x "
                              "{:.6g} mm",
                              side(0), side(1), side(2), printer.display[0], printer.display[1]),
                  "scale it with `scale`, or check `units`");
    if (map.box.min[k] < -slack || map.box.max[k] > printer.display[k] + slack)
      throw Error(Status::Limit, "`place`",
                  fmt::format("the model reaches from {:.6g} to {:.6g} mm along {}, the display "
                              "from 0 to {:.6g}",
                              map.box.min[k], map.box.max[k], "xy"[k], printer.display[k]),
                  "place it in the middle, which is the default");
  }
  if (map.box.min[2] < -kPlateRounding * side(2))
    throw Error(Status::Limit, "`place`",
                fmt::format("the model reaches {:.6g} mm below the plate", -map.box.min[2]),
                "place it in the middle, which is the default");
  if (printer.maxHeight > 0 && map.box.max[2] > printer.maxHeight * (1 + kPlateRounding))
    throw Error(Status::Limit, "",
                fmt::format("the model is {:.6g} mm high, the printer prints {:.6g} mm",
                            map.box.max[2], printer.maxHeight),
                "scale it with `scale`, or check `units`");
  return map;
}

LayerFrame frameOf(const PrinterSettings& printer, double top, LayerShare share) {
  const std::size_t across = printer.portrait ? 1 : 0;
  LayerFrame frame;
  frame.width = printer.pixels[across];
  frame.height = printer.pixels[1 - across];
  frame.pixelWidth = printer.display[across] / frame.width;
  frame.pixelHeight = printer.display[1 - across] / frame.height;
  frame.layerHeight = printer.layerHeight;
  frame.firstLayerHeight = printer.firstHeight();
  // A remainder above the last whole layer that is only rounding is not a layer.
  const double reached = top * (1 - kPlateRounding);
  double count = std::ceil((reached - frame.firstLayerHeight) / frame.layerHeight) + 1;
  if (count > kMaxLayers)
    throw Error(Status::Limit, "`layer_height`",
                fmt::format("{:.6g} mm are {:.0f} layers, more than 2^20", top, count),
                "give thicker layers");
  count = std::max(count, 1.0);
  frame.layers = static_cast<std::int32_t>(count);
  if (share != LayerShare::Volume && frame.layers > 1) {
    const std::int32_t last = frame.layers - 1;
    if (frame.bottomOf(last) + frame.heightOf(last) / 2 >= reached)
      --frame.layers;
  }
  return frame;
}

bool isMirrored(const PrinterSettings& printer) {
  return (printer.mirror[0] != printer.mirror[1]) == false;
}

std::array<double, 2> pixelOf(const PrinterSettings& printer, double x, double y) {
  const double alongX = x / printer.display[0] * printer.pixels[0];
  const double alongY = y / printer.display[1] * printer.pixels[1];
  const double farX = printer.pixels[0] - alongX, farY = printer.pixels[1] - alongY;
  if (printer.portrait)
    return {printer.mirror[0] ? alongY : farY, printer.mirror[1] ? alongX : farX};
  return {printer.mirror[0] ? farX : alongX, printer.mirror[1] ? alongY : farY};
}

std::array<double, 2> plateOf(const PrinterSettings& printer, double column, double row) {
  const std::size_t across = printer.portrait ? 1 : 0;
  const double width = printer.pixels[across], height = printer.pixels[1 - across];
  if (printer.portrait) {
    const double alongY = printer.mirror[0] ? column : width - column;
    const double alongX = printer.mirror[1] ? row : height - row;
    return {alongX / printer.pixels[0] * printer.display[0],
            alongY / printer.pixels[1] * printer.display[1]};
  }
  const double alongX = printer.mirror[0] ? width - column : column;
  const double alongY = printer.mirror[1] ? row : height - row;
  return {alongX / printer.pixels[0] * printer.display[0],
          alongY / printer.pixels[1] * printer.display[1]};
}

FrameFaces framedFaces(std::vector<Vec3d> points, std::vector<std::uint32_t> triangles,
                       const PlateMap& map, const PrinterSettings& printer, LayerShare share) {
  FrameFaces faces;
  faces.triangles = std::move(triangles);
  const std::size_t across = printer.portrait ? 1 : 0;
  const double width = printer.pixels[across], height = printer.pixels[1 - across];
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 16384),
                    [&](const auto& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        const Vec3d p = map(points[i]);
                        if (share == LayerShare::Contours) {
                          points[i] = p;
                          continue;
                        }
                        const auto [x, y] = pixelOf(printer, p[0], p[1]);
                        points[i] = {std::clamp(x, 0.0, width), std::clamp(y, 0.0, height), p[2]};
                      }
                    });
  faces.points = std::move(points);
  faces.mirrored = share != LayerShare::Contours && isMirrored(printer);
  return faces;
}

} // namespace tetvdb
