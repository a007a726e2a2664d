// SPDX-License-Identifier: Apache-2.0
//
// Describes findings of a print check.
#include "tetvdb/pipeline/CheckPrintJob.h"

#include <array>
#include <fmt/format.h>

namespace tetvdb {
namespace {

std::string layersOf(const PrintFinding& f) {
  return f.first == f.last ? fmt::format("layer {}", f.first)
                           : fmt::format("layers {} to {}", f.first, f.last);
}

std::string beyondText(const CheckPrintResult& result) {
  constexpr const char* kSides[3][2] = {{"x = 0", "the largest x"},
                                        {"y = 0", "the largest y"},
                                        {"the plate, below it", "the height"}};
  std::string text = "the model reaches";
  const char* between = " ";
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t side = 0; side < 2; ++side)
      if (result.beyond[k][side] > 0) {
        text +=
            fmt::format("{}{:.6g} mm beyond {}", between, result.beyond[k][side], kSides[k][side]);
        between = ", ";
      }
  return text;
}

std::string sizeText(const CheckPrintResult& result, const PrintFinding& f) {
  switch (f.fault) {
  case PrintFault::Outside:
    return beyondText(result);
  case PrintFault::EmptyLayer:
    return layersOf(f) + (f.first == f.last ? " is" : " are") + " empty";
  case PrintFault::Island: {
    std::string text = fmt::format("{:.4g} mm2 ({} pixels) begin in layer {} with nothing below",
                                   f.area, f.pixels, f.layer);
    if (f.joins < 0)
      return text + " and are never connected to the plate";
    return text + fmt::format(", grow to {:.4g} mm2 and join other solid {} layer{} above",
                              f.largestArea, f.joins - f.layer, f.joins - f.layer == 1 ? "" : "s");
  }
  case PrintFault::Overhang:
    return fmt::format("{:.4g} mm2 in {} overhang, {:.4g} mm2 ({} pixels) of it in layer {}",
                       f.totalArea, layersOf(f), f.area, f.pixels, f.layer);
  case PrintFault::Cup: {
    const std::string text =
        fmt::format("{:.4g} mm3 are a cup in {}, up to {:.4g} mm2 ({} pixels) in layer {}",
                    f.volume, layersOf(f), f.area, f.pixels, f.layer);
    if (f.onPlate)
      return text + ", closed by the plate until the model is taken off";
    return text + (f.joins < 0 ? ", open above"
                               : fmt::format(", open to the side from layer {} on", f.joins));
  }
  case PrintFault::Trap:
    return fmt::format("{:.4g} mm3 in {} have no way out, up to {:.4g} mm2 ({} pixels) in layer {}",
                       f.volume, layersOf(f), f.area, f.pixels, f.layer);
  case PrintFault::Drain:
    return fmt::format("a void in {} has no way out that is {:.4g} mm wide", layersOf(f),
                       result.limits.drain);
  case PrintFault::ThinWall:
  case PrintFault::ThinGap:
    return fmt::format("a {} up to {:.3g} mm wide in {}, {:.4g} mm2 ({} pixels) in layer {}",
                       f.fault == PrintFault::ThinWall ? "wall" : "gap", f.width, layersOf(f),
                       f.area, f.pixels, f.layer);
  case PrintFault::ThinFloor:
    return fmt::format("a floor or roof less than {:.4g} mm thick in {}, {:.4g} mm2 ({} pixels) in "
                       "layer {}",
                       result.limits.minFloor, layersOf(f), f.area, f.pixels, f.layer);
  }
  return {};
}

} // namespace

const char* nameOf(PrintFault fault) {
  constexpr std::array<const char*, 10> kNames = {"outside",  "empty-layer", "island", "overhang",
                                                  "cup",      "trap",        "drain",  "thin-wall",
                                                  "thin-gap", "thin-floor"};
  static_assert(kNames.size() == kPrintFaults);
  return kNames[static_cast<std::size_t>(fault)];
}

std::string textOf(const CheckPrintResult& result, std::size_t index) {
  const PrintFinding& f = result.checks.findings[index];
  const PrintPlace& place = result.places[index];
  std::string text = sizeText(result, f);
  if (f.fault == PrintFault::Outside || f.fault == PrintFault::EmptyLayer)
    return text;
  return text + fmt::format("; at {:.3f}, {:.3f}, {:.3f} mm on the plate, {:.6g}, {:.6g}, {:.6g} "
                            "in the model",
                            place.plate[0], place.plate[1], place.plate[2], place.model[0],
                            place.model[1], place.model[2]);
}

std::string cureFor(PrintFault fault, PrintTarget target) {
  const char* inside = target == PrintTarget::Lpbf ? "powder" : "resin";
  switch (fault) {
  case PrintFault::Outside:
    return "rotate or scale it, or check `units`";
  case PrintFault::EmptyLayer:
    return "move the upper part onto the rest, or onto the plate";
  case PrintFault::Island:
    return "support it, or rotate the model";
  case PrintFault::Overhang:
    return "support it, or rotate the model so that it is steeper";
  case PrintFault::Cup:
    return "give it a vent near its bottom, or rotate the model";
  case PrintFault::Trap:
    return fmt::format("give it holes that let {} out, or fill it", inside);
  case PrintFault::Drain:
    return fmt::format("widen its holes so that {} comes out, or fill it", inside);
  case PrintFault::ThinWall:
  case PrintFault::ThinFloor:
    return "make it thicker";
  case PrintFault::ThinGap:
    return "widen it, or close it";
  }
  return {};
}

} // namespace tetvdb
