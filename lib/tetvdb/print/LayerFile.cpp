// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/LayerFile.h"

#include "tetvdb/core/ClosestName.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/Formats.h"

#include <cctype>
#include <filesystem>

namespace tetvdb {
namespace {

std::vector<LayerFormat> makeTable() {
  std::vector<LayerFormat> all;
  const auto add = [&](std::string_view name, std::string_view endings,
                       std::string_view description, auto make) -> LayerFormat& {
    LayerFormat format;
    format.name = name;
    format.endings = endings;
    format.description = description;
    format.make = make;
    return all.emplace_back(format);
  };
  add("png", "", "A folder of 8-bit PNG files and manifest.json", writePngFolder).takesMaterials =
      true;
  add("bmp", "", "A folder of 1-bit BMP files and manifest.json", writeBmpFolder).oneBit = true;
  add("sl1", ".sl1 .sl1s", "Prusa's resin printers", writeSl1);
  add("zip", ".zip", "UVtools' generic ZIP", writeUvtoolsZip);
  add("nanodlp", ".nanodlp", "NanoDLP's plates", writeNanoDlp);
  add("goo", ".goo", "Elegoo's resin printers, version 3.0", writeGoo);
  add("cli", ".cli", "Common Layer Interface, text", writeCli).contours = true;
  add("cli-binary", ".cli", "Common Layer Interface, binary", writeCliBinary).contours = true;
  add("svg", ".svg", "One group of paths per layer, as Slic3r", writeSliceSvg).contours = true;
  LayerFormat& threeMf = add("3mf", ".3mf", "3MF with the slice extension", writeThreeMfSlices);
  threeMf.contours = threeMf.needsMesh = true;
  add("tif", ".tif .tiff", "Pages of 1 bit per pixel", writeTiffStack).oneBit = true;
  return all;
}

bool endsIn(const LayerFormat& format, const std::string& ending) {
  const std::string all = std::string(format.endings) + " ";
  return !ending.empty() && all.find(ending + " ") != std::string::npos;
}

} // namespace

std::string PrintInfo::name() const {
  std::string result;
  for (const char c : std::filesystem::path(path).stem().string())
    result += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' ? c : '_';
  return result.empty() ? "print" : result;
}

const std::vector<LayerFormat>& layerFormats() {
  static const std::vector<LayerFormat> table = makeTable();
  return table;
}

const LayerFormat& layerFormatFor(const std::string& path, const std::string& name) {
  std::vector<std::string> names;
  std::string endings;
  const std::string ending = endingOf(path);
  for (const LayerFormat& format : layerFormats()) {
    if (name.empty() ? endsIn(format, ending) : format.name == name)
      return format;
    names.emplace_back(format.name);
    if (!format.endings.empty() && endings.find(format.endings) == std::string::npos)
      (endings += endings.empty() ? "" : " ") += format.endings;
  }
  if (name.empty() && ending.empty())
    return layerFormats().front();
  if (name.empty())
    throw Error(Status::Usage, path, "cannot write layers to files that end in '" + ending + "'",
                "name it " + endings + ", without an ending for a folder, or give `format`");
  std::string list;
  for (const std::string& one : names)
    (list += list.empty() ? "" : ", ") += one;
  throw Error(Status::Usage, "`format`", "'" + name + "' is not a format of layers",
              suggestName(name, names, "choose from " + list));
}

} // namespace tetvdb
