// SPDX-License-Identifier: Apache-2.0
//
// Folders of images. BMP: Microsoft's "Bitmap Storage", BITMAPINFOHEADER.
#include "tetvdb/core/Version.h"
#include "tetvdb/print/LayerBits.h"
#include "tetvdb/print/LayerFile.h"
#include "tetvdb/print/LayerFolder.h"
#include "tetvdb/print/LittleEndian.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace tetvdb {
namespace {

using Json = nlohmann::ordered_json;

class ImageFolder : public LayerWriter {
public:
  ImageFolder(const PrintInfo& info, std::string_view ending)
      : info_(info), folder_(info.path, "layer", ending) {}

  void add(std::int32_t k, const EncodedLayer& layer) override {
    const std::string name = folder_.nameOf(k);
    folder_.write(name, layer.bytes);
    const LayerFrame& frame = info_.frame;
    layers_.push_back({{"file", name},
                       {"bottom_mm", frame.bottomOf(k)},
                       {"height_mm", frame.heightOf(k)},
                       {"area_mm2", layer.filled * frame.pixelWidth * frame.pixelHeight},
                       {"exposure_s", info_.printer.exposureOf(k)}});
  }

  void finish() override {
    const LayerFrame& frame = info_.frame;
    Json manifest = {{"creator", std::string("TetVDB ") + version()},
                     {"width_px", frame.width},
                     {"height_px", frame.height},
                     {"pixel_mm", {frame.pixelWidth, frame.pixelHeight}},
                     {"layer_height_mm", frame.layerHeight},
                     {"first_layer_height_mm", frame.firstLayerHeight},
                     {"aa", info_.aa},
                     {"orientation", info_.printer.portrait ? "portrait" : "landscape"},
                     {"mirror", info_.printer.mirror},
                     {"box_mm", {{"min", info_.box.min}, {"max", info_.box.max}}}};
    if (!info_.palette.empty()) {
      Json materials = Json::array();
      for (std::size_t i = 0; i < info_.palette.size(); ++i)
        materials.push_back({{"value", i},
                             {"name", i < info_.materials.size() ? info_.materials[i] : ""},
                             {"color", info_.palette[i]}});
      manifest["materials"] = materials;
    }
    manifest["layers"] = std::move(layers_);
    folder_.write("manifest.json",
                  manifest.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
    folder_.commit();
  }
  std::uint64_t bytes() const override { return folder_.bytes(); }

protected:
  const PrintInfo info_;

private:
  LayerFolder folder_;
  Json layers_ = Json::array();
};

class PngFolder : public ImageFolder {
public:
  explicit PngFolder(const PrintInfo& info) : ImageFolder(info, ".png") {}
  EncodedLayer encode(std::int32_t, const Layer& layer) const override {
    return {encodeLayerPng(layer, info_.frame.width, info_.frame.height, info_.palette), "",
            layer.filled, layer.overlap, layer.empty()};
  }
};

class BmpFolder : public ImageFolder {
public:
  explicit BmpFolder(const PrintInfo& info) : ImageFolder(info, ".bmp") {}
  EncodedLayer encode(std::int32_t, const Layer& layer) const override {
    const LayerFrame& frame = info_.frame;
    const std::size_t rowBytes = (static_cast<std::size_t>(frame.width) + 31) / 32 * 4;
    const std::size_t head = 14 + 40 + 2 * 4;
    const std::size_t size = rowBytes * static_cast<std::size_t>(frame.height);
    const auto perMetre = [](double millimetres) {
      return static_cast<std::uint64_t>(std::lround(1000 / millimetres));
    };
    std::string file = "BM" + littleEndianBytes(head + size, 4) + littleEndianBytes(0, 4) +
                       littleEndianBytes(head, 4);
    file += littleEndianBytes(40, 4) +
            littleEndianBytes(static_cast<std::uint64_t>(frame.width), 4) +
            littleEndianBytes(static_cast<std::uint64_t>(frame.height), 4) +
            littleEndianBytes(1, 2) + littleEndianBytes(1, 2) + littleEndianBytes(0, 4) +
            littleEndianBytes(size, 4) + littleEndianBytes(perMetre(frame.pixelWidth), 4) +
            littleEndianBytes(perMetre(frame.pixelHeight), 4) + littleEndianBytes(2, 4) +
            littleEndianBytes(0, 4);
    file += littleEndianBytes(0, 4) + littleEndianBytes(0xffffff, 4); // black, white
    file.resize(head + size, '\0');
    for (std::size_t i = 0; i < layer.rows.size(); ++i) { // the lowest row comes first
      const auto row = static_cast<std::size_t>(frame.height - 1 - layer.rows[i].y);
      setRowBits(layer, i, file.data() + head + row * rowBytes);
    }
    return {std::move(file), "", layer.filled, layer.overlap, layer.empty()};
  }
};

} // namespace

std::unique_ptr<LayerWriter> writePngFolder(const PrintInfo& info) {
  return std::make_unique<PngFolder>(info);
}
std::unique_ptr<LayerWriter> writeBmpFolder(const PrintInfo& info) {
  return std::make_unique<BmpFolder>(info);
}

} // namespace tetvdb
