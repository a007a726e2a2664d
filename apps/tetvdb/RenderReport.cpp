// SPDX-License-Identifier: Apache-2.0
#include "JobReport.h"
#include "tetvdb/io/Formats.h"

#include <cmath>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

// null where there is none: JSON has no infinity.
Json numberOf(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Json inputOf(const InputInfo& info, bool isVolume) {
  if (isVolume)
    return {{"path", info.path}, {"kind", "volume"}};
  const bool hasTets = info.tets > 0;
  return {{"path", info.path},
          {"format", formatName(info.format)},
          {"kind", hasTets ? "tets" : "triangles"},
          {"vertices", info.vertices},
          {hasTets ? "tets" : "triangles", hasTets ? info.tets : info.triangles}};
}

Json pictureOf(const RenderResult& result, const std::string& view, bool defects) {
  Json subjects = Json::array();
  for (const Drawn& drawn : result.drawn) {
    Json subject = {{"triangles", drawn.triangles}, {"cut_tets", drawn.cutTets}};
    if (defects)
      subject["defects"] = {{"open_edges", drawn.openEdges},
                            {"nonmanifold_edges", drawn.nonManifoldEdges},
                            {"flipped_faces", drawn.flippedFaces}};
    subjects.push_back(subject);
  }
  Json colors;
  if (result.scale) {
    colors = {{"title", result.scale->title}};
    if (result.scale->kinds.empty()) {
      colors["low"] = numberOf(result.scale->low);
      colors["high"] = numberOf(result.scale->high);
      colors["logarithmic"] = result.scale->logarithmic;
    } else {
      colors["kinds"] = result.scale->kinds;
    }
  }
  return {
      {"width", result.width}, {"height", result.height},
      {"view", view},          {"pictures", std::max(result.outputs.size(), result.kept.size())},
      {"colors", colors},      {"subjects", subjects}};
}

} // namespace

Json sectionsOf(const RenderJob& job, const RenderResult& result) {
  Json sections = {
      {"device", "cpu"},        {"threads", threadsOf(job.threads)},
      {"input", Json::array()}, {"picture", pictureOf(result, job.picture.view, job.look.defects)},
      {"stages", nullptr},      {"output", Json::array()}};
  for (std::size_t i = 0; i < result.inputs.size(); ++i)
    sections["input"].push_back(inputOf(result.inputs[i], job.inputs[i].isVolume));
  for (const OutputInfo& output : result.outputs)
    sections["output"].push_back({{"path", output.path}, {"bytes", output.bytes}});
  return sections;
}

} // namespace tetvdb::cli
