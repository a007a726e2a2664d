// SPDX-License-Identifier: Apache-2.0
//
// Common base of containers that are ZIP archives of PNG files. Internal.
#pragma once

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/io/text/ZipWriter.h"
#include "tetvdb/print/LayerFile.h"

#include <string>

namespace tetvdb {

/// Layers become PNG files, stored without further compression. A format defines their names, and
/// adds its other files in end().
class ZipLayers : public LayerWriter {
public:
  explicit ZipLayers(const PrintInfo& info) : info_(info), file_(info.path), zip_(file_) {}

  EncodedLayer encode(std::int32_t, const Layer& layer) const override {
    return {encodeLayerPng(layer, info_.frame.width, info_.frame.height), "", layer.filled,
            layer.overlap, layer.empty()};
  }
  void add(std::int32_t k, const EncodedLayer& layer) override {
    put(nameOf(k), layer.bytes, ZipMethod::Stored);
    filled_ += layer.filled * info_.frame.heightOf(k);
  }
  void finish() override {
    end();
    zip_.finish();
    bytes_ = file_.size();
    file_.commit();
  }
  std::uint64_t bytes() const override { return bytes_; }

protected:
  virtual std::string nameOf(std::int32_t k) const = 0;
  virtual void end() = 0;

  void put(const std::string& name, const std::string& bytes,
           ZipMethod method = ZipMethod::Deflated) {
    zip_.begin(name, method, bytes.size());
    zip_.write(bytes);
    zip_.end();
  }
  /// Cubic millimetres of all layers so far.
  double volume() const { return filled_ * info_.frame.pixelWidth * info_.frame.pixelHeight; }

  const PrintInfo info_;

private:
  AtomicFile file_;
  ZipWriter zip_;
  double filled_ = 0;
  std::uint64_t bytes_ = 0;
};

/// Seconds of all exposures.
inline double exposureTime(const PrintInfo& info) {
  double seconds = 0;
  for (std::int32_t k = 0; k < info.frame.layers; ++k)
    seconds += info.printer.exposureOf(k);
  return seconds;
}

} // namespace tetvdb
