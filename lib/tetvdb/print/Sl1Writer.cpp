// SPDX-License-Identifier: Apache-2.0
//
// Format: as written by PrusaSlicer 2.5, with the content that its reader and UVtools' require.
#include "tetvdb/core/Version.h"
#include "tetvdb/print/ZipLayers.h"

#include <cstdlib>
#include <fmt/format.h>

namespace tetvdb {
namespace {

class Sl1Writer : public ZipLayers {
public:
  using ZipLayers::ZipLayers;

private:
  std::string nameOf(std::int32_t k) const override {
    return fmt::format("{}{:05}.png", info_.name(), k);
  }

  void end() override {
    put("config.ini", config());
    put("prusaslicer.ini", settings());
  }

  std::string keyOr(const std::string& key, const std::string& other) const {
    const auto found = info_.printer.keys.find(key);
    return found == info_.printer.keys.end() ? other : found->second;
  }

  // Bytes depend on the input only: the date is constant.
  std::string config() const {
    const PrinterSettings& printer = info_.printer;
    const double tilt = std::strtod(keyOr("fast_tilt_time", "5").c_str(), nullptr);
    const double seconds = exposureTime(info_) + tilt * info_.frame.layers;
    std::string text;
    const auto line = [&](const char* key, const auto& value) {
      text += fmt::format("{} = {}\n", key, value);
    };
    line("action", "print");
    line("expTime", printer.exposure);
    line("expTimeFirst", printer.exposureOf(0));
    line("expUserProfile", 0);
    line("fileCreationTimestamp", "1980-01-01 at 00:00:00 UTC");
    line("hollow", 0);
    line("jobDir", info_.name());
    line("layerHeight", info_.frame.layerHeight);
    line("materialName", keyOr("sla_material_settings_id", ""));
    line("numFade", printer.fadedLayers);
    line("numFast", info_.frame.layers);
    line("numSlow", 0);
    line("printProfile", keyOr("sla_print_settings_id", ""));
    line("printTime", fmt::format("{:.6f}", seconds));
    line("printerModel", keyOr("printer_model", "SL1"));
    line("printerProfile", keyOr("printer_settings_id", ""));
    line("printerVariant", keyOr("printer_variant", "default"));
    line("prusaSlicerVersion", std::string("TetVDB-") + version());
    line("usedMaterial", fmt::format("{:.6f}", volume() / 1000));
    return text;
  }

  std::string settings() const {
    const PrinterSettings& printer = info_.printer;
    std::map<std::string, std::string> keys = printer.keys;
    const auto set = [&](const char* key, const auto& value) {
      keys[key] = fmt::format("{}", value);
    };
    set("display_height", printer.display[1]);
    set("display_mirror_x", int(printer.mirror[0]));
    set("display_mirror_y", int(printer.mirror[1]));
    set("display_orientation", printer.portrait ? "portrait" : "landscape");
    set("display_pixels_x", printer.pixels[0]);
    set("display_pixels_y", printer.pixels[1]);
    set("display_width", printer.display[0]);
    set("exposure_time", printer.exposure);
    set("faded_layers", printer.fadedLayers);
    set("gamma_correction", printer.gamma);
    set("initial_exposure_time", printer.exposureOf(0));
    set("initial_layer_height", info_.frame.firstLayerHeight);
    set("layer_height", info_.frame.layerHeight);
    set("max_print_height", printer.maxHeight);
    set("printer_technology", "SLA");
    std::string text;
    for (const auto& [key, value] : keys)
      text += key + " = " + value + "\n";
    return text;
  }
};

class UvtoolsZipWriter : public ZipLayers {
public:
  using ZipLayers::ZipLayers;

private:
  std::string nameOf(std::int32_t k) const override { return fmt::format("{}.png", k + 1); }

  void end() override {
    const PrinterSettings& printer = info_.printer;
    const LayerFrame& frame = info_.frame;
    const std::string creator = std::string("TetVDB ") + version();
    std::string xml = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Manifest>\n";
    const auto line = [&](const char* key, const auto& value) {
      xml += fmt::format("  <{0}>{1}</{0}>\n", key, value);
    };
    line("CreatedBy", creator);
    line("UpdatedBy", creator);
    line("CreatedDate", "1980-01-01 00:00:00Z");
    line("LastModifiedDate", "1980-01-01 00:00:00Z");
    line("LayerHeight", frame.layerHeight);
    line("ResolutionX", frame.width);
    line("ResolutionY", frame.height);
    line("DisplayWidth", frame.pixelWidth * frame.width);
    line("DisplayHeight", frame.pixelHeight * frame.height);
    line("MachineZ", printer.maxHeight);
    put("manifest.uvtools", xml + "</Manifest>\n");
  }
};

} // namespace

std::unique_ptr<LayerWriter> writeSl1(const PrintInfo& info) {
  return std::make_unique<Sl1Writer>(info);
}
std::unique_ptr<LayerWriter> writeUvtoolsZip(const PrintInfo& info) {
  return std::make_unique<UvtoolsZipWriter>(info);
}

} // namespace tetvdb
