// SPDX-License-Identifier: Apache-2.0
#include "CheckReport.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <functional>
#include <map>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

Json limitsOf(const PrintLimits& limits, bool outside) {
  const auto limit = [](double value) { return value > 0 ? Json(value) : Json(); };
  return {{"outside", outside},
          {"empty_layers", limits.emptyLayers},
          {"islands", limits.islands},
          {"cups", limits.cups},
          {"traps", limits.traps},
          {"overhang_angle", limit(limits.overhangAngle)},
          {"min_wall_mm", limit(limits.minWall)},
          {"min_floor_mm", limit(limits.minFloor)},
          {"min_gap_mm", limit(limits.minGap)},
          {"drain_mm", limit(limits.drain)},
          {"min_area_mm2", limits.minArea},
          {"min_volume_mm3", limits.minVolume},
          {"connectivity", limits.neighbours == Neighbours::Four ? 4 : 8}};
}

Json printOf(const CheckPrintResult& result, const CheckPrintJob& job) {
  const LayerFrame& frame = result.slice.frame;
  Json leftOut = Json::object();
  for (std::size_t i = 0; i < kPrintFaults; ++i)
    if (result.checks.leftOut[i] > 0)
      leftOut[nameOf(static_cast<PrintFault>(i))] = result.checks.leftOut[i];
  return {{"layers", frame.layers},
          {"empty_layers", result.checks.emptyLayers},
          {"pixels", result.printer.pixels},
          {"pixel_mm", {frame.pixelWidth, frame.pixelHeight}},
          {"layer_height_mm", frame.layerHeight},
          {"first_layer_height_mm", frame.firstLayerHeight},
          {"plate_known", job.plateKnown},
          {"box_mm", {{"min", result.slice.box.min}, {"max", result.slice.box.max}}},
          {"volume_mm3", result.checks.volume},
          {"repaired", result.slice.repaired},
          {"remeshed", result.slice.remeshed},
          {"limits", limitsOf(job.limits, job.outside)},
          {"left_out", leftOut}};
}

Json findingOf(const CheckPrintResult& result, std::size_t i, PrintTarget target,
               TextOf nameSettings) {
  const PrintFinding& f = result.checks.findings[i];
  Json finding = {{"code", nameOf(f.fault)},
                  {"text", nameSettings(textOf(result, i))},
                  {"cure", nameSettings(cureFor(f.fault, target))},
                  {"layer", f.layer},
                  {"first_layer", f.first},
                  {"last_layer", f.last},
                  {"height_mm", f.height},
                  {"plate_mm", result.places[i].plate},
                  {"model", result.places[i].model},
                  {"model_box", {{"min", result.places[i].low}, {"max", result.places[i].high}}}};
  if (f.fault == PrintFault::Outside) {
    finding["beyond_mm"] = result.beyond;
    return finding;
  }
  if (f.fault == PrintFault::EmptyLayer)
    return finding;
  finding["pixel"] = f.pixel;
  finding["box_px"] = {{"min", {f.box.minX, f.box.minY}}, {"max", {f.box.maxX, f.box.maxY}}};
  finding["pixels"] = f.pixels;
  finding["area_mm2"] = f.area;
  switch (f.fault) {
  case PrintFault::Island:
    finding["largest_area_mm2"] = f.largestArea;
    finding["joins_layer"] = f.joins < 0 ? Json() : Json(f.joins);
    break;
  case PrintFault::Overhang:
    finding["total_area_mm2"] = f.totalArea;
    break;
  case PrintFault::Cup:
    finding["volume_mm3"] = f.volume;
    finding["on_plate"] = f.onPlate;
    finding["opens_layer"] = f.joins < 0 ? Json() : Json(f.joins);
    break;
  case PrintFault::Trap:
  case PrintFault::Drain:
    finding["volume_mm3"] = f.volume;
    break;
  case PrintFault::ThinWall:
  case PrintFault::ThinGap:
    finding["width_mm"] = f.width;
    break;
  case PrintFault::Outside:
  case PrintFault::EmptyLayer:
  case PrintFault::ThinFloor:
    break;
  }
  return finding;
}

} // namespace

void chooseChecks(const std::string& option, const std::string& list, CheckPrintJob& job) {
  PrintLimits& limits = job.limits;
  const PrintLimits usual = limitsFor(job.target);
  const PrintLimits sla = limitsFor(PrintTarget::Sla);
  const std::map<std::string, std::function<void(PrintLimits&)>> checks = {
      {"outside", [&](PrintLimits&) { job.outside = true; }},
      {"empty", [](PrintLimits& l) { l.emptyLayers = true; }},
      {"islands", [](PrintLimits& l) { l.islands = true; }},
      {"overhangs", [&](PrintLimits& l) { l.overhangAngle = usual.overhangAngle; }},
      {"cups", [](PrintLimits& l) { l.cups = true; }},
      {"traps", [](PrintLimits& l) { l.traps = true; }},
      {"drains", [&](PrintLimits& l) { l.drain = usual.drain > 0 ? usual.drain : sla.drain; }},
      {"walls", [&](PrintLimits& l) { l.minWall = usual.minWall; }},
      {"floors", [&](PrintLimits& l) { l.minFloor = usual.minFloor; }},
      {"gaps", [&](PrintLimits& l) { l.minGap = usual.minGap; }}};
  limits.emptyLayers = limits.islands = limits.cups = limits.traps = job.outside = false;
  limits.overhangAngle = limits.minWall = limits.minGap = limits.minFloor = limits.drain = 0;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string name = list.substr(begin, end - begin);
    const auto check = checks.find(name);
    if (check == checks.end())
      throw Error(Status::Usage, option, "'" + name + "' is no check",
                  "choose from outside, empty, islands, overhangs, cups, traps, drains, walls, "
                  "floors and gaps, with commas between them");
    check->second(limits);
    begin = end + 1;
  }
}

std::string wordFor(Finding::Weight weight) {
  switch (weight) {
  case Finding::Weight::Error:
    return "error";
  case Finding::Weight::Warning:
    return "warning";
  case Finding::Weight::Note:
    break;
  }
  return "note";
}

Json toJson(const Finding& finding, TextOf textOf) {
  return {{"weight", wordFor(finding.weight)},
          {"code", finding.code},
          {"file", finding.file},
          {"grid", finding.grid},
          {"text", textOf(finding.text)},
          {"cure", textOf(finding.cure)}};
}

void addSections(const CheckPrintJob& job, const CheckPrintResult& result, TextOf textOf,
                 bool withFindings, Json& sections) {
  sections["print"] = printOf(result, job);
  sections["findings"] = Json::array();
  for (std::size_t i = 0; withFindings && i < result.checks.findings.size(); ++i)
    sections["findings"].push_back(findingOf(result, i, job.target, textOf));
}

} // namespace tetvdb::cli
