// SPDX-License-Identifier: Apache-2.0
//
// Writes layers to files: the table of formats, and the input of their writers.
//
//   const tetvdb::LayerFormat* format = tetvdb::layerFormatFor("part.sl1", "");
//   std::unique_ptr<tetvdb::LayerWriter> writer = format->make(info);
//   forEachLayer(source, [&](auto k, auto&& layer) { return writer->encode(k, layer); },
//                [&](auto k, auto&& encoded) { writer->add(k, encoded); }, progress);
//   writer->finish();
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/print/Layer.h"
#include "tetvdb/print/LayerPng.h"
#include "tetvdb/print/PrinterSettings.h"
#include "tetvdb/voxelize/ChooseTransform.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

/// The content of a file besides its layers.
struct PrintInfo {
  std::string path; ///< of the file, or of the folder
  LayerFrame frame;
  PrinterSettings printer;
  WorldBox box;                       ///< of the model on the plate, millimetres
  std::string aa;                     ///< "area", "volume" or "none"
  std::vector<PngColor> palette;      ///< of materials; 0 is the background; empty: grey levels
  std::vector<std::string> materials; ///< their names, that of the background first
  const TriangleMesh* mesh = nullptr; ///< on the plate, for formats that need one
  /// The name without folder and ending, with letters, digits, '-' and '_' only.
  std::string name() const;
};

/// A layer in the representation of a format.
struct EncodedLayer {
  std::string bytes;
  std::string note;  ///< information about the layer that a format stores elsewhere
  double filled = 0; ///< as Layer::filled
  double overlap = 0;
  bool empty = true;
};

/// One file or folder that is whole after finish(), and absent if it is not called.
class LayerWriter {
public:
  virtual ~LayerWriter() = default;
  /// Thread-safe.
  virtual EncodedLayer encode(std::int32_t k, const Layer& layer) const = 0;
  /// Adds layers in order, from 0; `layer` is the result of encode(). Throws Error(Write).
  virtual void add(std::int32_t k, const EncodedLayer& layer) = 0;
  virtual void finish() = 0;
  /// Size of the written files, after finish(); for a folder, of its files.
  virtual std::uint64_t bytes() const = 0;
};

struct LayerFormat {
  std::string_view name;        ///< for --format and reports
  std::string_view endings;     ///< lower case, the usual one first; empty: a folder
  std::string_view description; ///< one line, without a full stop
  bool contours = false;        ///< lines instead of pixels
  bool needsMesh = false;       ///< PrintInfo::mesh
  bool takesMaterials = false;  ///< PrintInfo::palette
  bool oneBit = false;          ///< a pixel is black or white
  std::unique_ptr<LayerWriter> (*make)(const PrintInfo&) = nullptr;
};

/// All rows.
const std::vector<LayerFormat>& layerFormats();

/// The format of that name. For an empty name, that of the path's ending; for a path without
/// ending, the folder of PNG files. Throws Error(Usage) if there is none, with the existing ones.
const LayerFormat& layerFormatFor(const std::string& path, const std::string& name);

// The rows' writers, one per source file.
std::unique_ptr<LayerWriter> writePngFolder(const PrintInfo& info);
std::unique_ptr<LayerWriter> writeBmpFolder(const PrintInfo& info);
std::unique_ptr<LayerWriter> writeSl1(const PrintInfo& info);
std::unique_ptr<LayerWriter> writeUvtoolsZip(const PrintInfo& info);
std::unique_ptr<LayerWriter> writeNanoDlp(const PrintInfo& info);
std::unique_ptr<LayerWriter> writeGoo(const PrintInfo& info);
std::unique_ptr<LayerWriter> writeCli(const PrintInfo& info);
std::unique_ptr<LayerWriter> writeCliBinary(const PrintInfo& info);
std::unique_ptr<LayerWriter> writeSliceSvg(const PrintInfo& info);
std::unique_ptr<LayerWriter> writeThreeMfSlices(const PrintInfo& info);
std::unique_ptr<LayerWriter> writeTiffStack(const PrintInfo& info);

} // namespace tetvdb
