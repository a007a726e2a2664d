// SPDX-License-Identifier: Apache-2.0
#include "JobReport.h"
#include "tetvdb/io/Formats.h"

#include <utility>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

Json inputsOf(const SliceResult& result, const std::vector<std::string>& paths) {
  Json inputs = Json::array();
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const InputInfo* info = i < result.inputs.size() ? &result.inputs[i] : nullptr;
    Json input = inputSection(paths[i], result.source, info);
    if (info != nullptr) {
      if (result.source == SolidSource::Tets)
        input["tets"] = info->tets;
      else
        input["triangles"] = info->triangles;
    }
    inputs.push_back(std::move(input));
  }
  return inputs;
}

Json slicesOf(const SliceResult& result) {
  const LayerFrame& frame = result.frame;
  Json slices = {{"format", result.format},
                 {"layers", frame.layers},
                 {"empty_layers", result.emptyLayers},
                 {"width_px", frame.width},
                 {"height_px", frame.height},
                 {"pixel_mm", {frame.pixelWidth, frame.pixelHeight}},
                 {"layer_height_mm", frame.layerHeight},
                 {"first_layer_height_mm", frame.firstLayerHeight},
                 {"box_mm", {{"min", result.box.min}, {"max", result.box.max}}},
                 {"mesh_volume_mm3", result.meshVolume > 0 ? Json(result.meshVolume) : Json()},
                 {"volume_mm3", result.volume},
                 {"overlap_mm3", result.overlap},
                 {"repaired", result.repaired},
                 {"remeshed", result.remeshed}};
  if (!result.materials.empty())
    slices["materials"] = result.materials;
  if (result.source == SolidSource::Triangles)
    slices["cleaned"] = toJson(result.cleaned);
  return slices;
}

} // namespace

Json sectionsOf(const SliceJob& job, const SliceResult& result) {
  Json sections = {{"device", "cpu"},
                   {"threads", threadsOf(job.threads)},
                   {"input", inputsOf(result, job.inputs)},
                   {"stages", nullptr},
                   {"slices", slicesOf(result)},
                   {"output", Json::array()}};
  if (!result.output.path.empty())
    sections["output"].push_back({{"path", result.output.path}, {"bytes", result.output.bytes}});
  return sections;
}

} // namespace tetvdb::cli
