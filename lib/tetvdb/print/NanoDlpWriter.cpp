// SPDX-License-Identifier: Apache-2.0
//
// Format: NanoDLP's plate archives, as UVtools and PrusaSlicer's descendants write and read them.
#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/core/Version.h"
#include "tetvdb/print/ZipLayers.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace tetvdb {
namespace {

using Json = nlohmann::ordered_json;

// A layer's islands: pixels above 0 connected along rows and columns.
struct LayerIslands {
  std::vector<double> pixels; ///< of each
  std::int32_t minX = std::numeric_limits<std::int32_t>::max(), minY = minX, maxX = -1, maxY = -1;
};

LayerIslands islandsOf(const Layer& layer) {
  LayerIslands result;
  DisjointSets sets(layer.runs.size());
  for (std::size_t i = 0; i < layer.rows.size(); ++i) {
    const auto [begin, end] = layer.runsOf(i);
    const bool follows = i > 0 && layer.rows[i - 1].y + 1 == layer.rows[i].y;
    const PixelRun* below = follows ? layer.runsOf(i - 1).first : begin;
    const PixelRun* belowEnd = follows ? layer.runsOf(i - 1).second : begin;
    const auto number = [&](const PixelRun* run) {
      return static_cast<std::uint32_t>(run - layer.runs.data());
    };
    for (const PixelRun* run = begin; run != end; ++run) {
      if (run != begin && run[-1].end == run->begin)
        sets.join(number(run - 1), number(run));
      while (below != belowEnd && below->end <= run->begin)
        ++below;
      for (const PixelRun* other = below; other != belowEnd && other->begin < run->end; ++other)
        sets.join(number(other), number(run));
      result.minX = std::min(result.minX, run->begin);
      result.maxX = std::max(result.maxX, run->end - 1);
    }
    result.minY = std::min(result.minY, layer.rows[i].y);
    result.maxY = std::max(result.maxY, layer.rows[i].y);
  }
  std::vector<double> pixels(layer.runs.size(), 0);
  for (std::uint32_t i = 0; i < layer.runs.size(); ++i)
    pixels[sets.find(i)] += layer.runs[i].end - layer.runs[i].begin;
  for (const double count : pixels)
    if (count > 0)
      result.pixels.push_back(count);
  return result;
}

class NanoDlpWriter : public ZipLayers {
public:
  using ZipLayers::ZipLayers;

  EncodedLayer encode(std::int32_t k, const Layer& layer) const override {
    EncodedLayer encoded = ZipLayers::encode(k, layer);
    LayerIslands islands = islandsOf(layer);
    if (islands.pixels.empty()) {
      islands.pixels = {0};
      islands.minX = islands.minY = islands.maxX = islands.maxY = 0;
    }
    const double pixel = info_.frame.pixelWidth * info_.frame.pixelHeight;
    const auto [low, high] = std::minmax_element(islands.pixels.begin(), islands.pixels.end());
    encoded.note = Json({{"TotalSolidArea", layer.filled * pixel},
                         {"LargestArea", *high * pixel},
                         {"SmallestArea", *low * pixel},
                         {"MinX", islands.minX},
                         {"MinY", islands.minY},
                         {"MaxX", islands.maxX},
                         {"MaxY", islands.maxY},
                         {"AreaCount", layer.empty() ? 0 : islands.pixels.size()}})
                       .dump();
    return encoded;
  }

  void add(std::int32_t k, const EncodedLayer& layer) override {
    ZipLayers::add(k, layer);
    notes_ += (k == 0 ? "[" : ",\n") + layer.note;
  }

private:
  std::string nameOf(std::int32_t k) const override { return fmt::format("{}.png", k + 1); }

  void end() override {
    const PrinterSettings& printer = info_.printer;
    const LayerFrame& frame = info_.frame;
    const auto text = [](const Json& json) {
      return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
    };
    constexpr double kMicrons = 1000;
    put("meta.json", text({{"FormatVersion", 1},
                           {"Distro", "generic"},
                           {"Program", "TetVDB"},
                           {"Version", version()},
                           {"OS", "linux"},
                           {"Arch", "generic"},
                           {"Profile", false}}));
    put("plate.json", text({{"ProfileID", 0},
                            {"Path", info_.name()},
                            {"Processed", true},
                            {"TotalSolidArea", 0},
                            {"LayersCount", frame.layers},
                            {"XRes", frame.width},
                            {"YRes", frame.height},
                            {"XPixelSize", frame.pixelWidth * kMicrons},
                            {"YPixelSize", frame.pixelHeight * kMicrons},
                            {"ZMin", 0},
                            {"ZMax", frame.bottomOf(frame.layers)},
                            {"XMin", info_.box.min[0]},
                            {"XMax", info_.box.max[0]},
                            {"YMin", info_.box.min[1]},
                            {"YMax", info_.box.max[1]}}));
    put("info.json", notes_ + "]\n");
    put("profile.json", text({{"Title", info_.name()},
                              {"Depth", frame.layerHeight * kMicrons},
                              {"SupportDepth", frame.firstLayerHeight * kMicrons},
                              {"CureTime", printer.exposure},
                              {"SupportCureTime", printer.exposureOf(0)},
                              {"SupportLayerNumber", printer.bottomLayers},
                              {"TransitionalLayer", printer.fadedLayers}}));
    put("3d.png", encodeLayerPng({}, 200, 100), ZipMethod::Stored);
  }

  std::string notes_;
};

} // namespace

std::unique_ptr<LayerWriter> writeNanoDlp(const PrintInfo& info) {
  return std::make_unique<NanoDlpWriter>(info);
}

} // namespace tetvdb
