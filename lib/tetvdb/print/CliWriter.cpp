// SPDX-License-Identifier: Apache-2.0
//
// Format: "Common Layer Interface (CLI)", version 2.0.
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/print/ContourLines.h"
#include "tetvdb/print/LayerFile.h"
#include "tetvdb/print/LittleEndian.h"

#include <cstring>
#include <fmt/format.h>

namespace tetvdb {
namespace {

constexpr int kPart = 1;
constexpr int kInner = 0, kOuter = 1;

int directionOf(const LayerContour& contour) {
  return areaOf(contour) < 0 ? kInner : kOuter;
}

// The first layer is the plate: it is empty, and gives the height of the first with material.
class CliWriter : public LayerWriter {
public:
  CliWriter(const PrintInfo& info, bool binary) : info_(info), binary_(binary), file_(info.path) {
    const WorldBox& box = info.box;
    write(fmt::format("$$HEADERSTART\n$${}\n$$UNITS/1\n$$VERSION/200\n$$LABEL/{},{}\n"
                      "$$DIMENSION/{},{},{},{},{},{}\n$$LAYERS/{}\n$$HEADEREND",
                      binary ? "BINARY" : "ASCII", kPart, info.name(), box.min[0], box.min[1],
                      box.min[2], box.max[0], box.max[1], box.max[2], info.frame.layers + 1));
    if (!binary)
      write("\n$$GEOMETRYSTART\n");
    write(startOf(0));
  }

  EncodedLayer encode(std::int32_t k, const Layer& layer) const override {
    std::string text = startOf(info_.frame.bottomOf(k + 1));
    for (const LayerContour& contour : layer.contours) {
      const std::size_t count = contour.size() + 1; // the first point is repeated
      if (binary_) {
        text += littleEndianBytes(130, 2) + littleEndianBytes(kPart, 4) +
                littleEndianBytes(static_cast<std::uint64_t>(directionOf(contour)), 4) +
                littleEndianBytes(count, 4);
        for (std::size_t i = 0; i < count; ++i)
          for (const double c : contour[i % contour.size()])
            text += real(c);
        continue;
      }
      text += fmt::format("$$POLYLINE/{},{},{}", kPart, directionOf(contour), count);
      for (std::size_t i = 0; i < count; ++i)
        for (const double c : contour[i % contour.size()])
          text += fmt::format(",{}", c);
      text += '\n';
    }
    return {std::move(text), "", layer.filled, layer.overlap, layer.empty()};
  }

  void add(std::int32_t, const EncodedLayer& layer) override { write(layer.bytes); }

  void finish() override {
    if (!binary_)
      write("$$GEOMETRYEND\n");
    bytes_ = file_.size();
    file_.commit();
  }
  std::uint64_t bytes() const override { return bytes_; }

private:
  static std::string real(double number) {
    const auto value = static_cast<float>(number);
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return littleEndianBytes(bits, 4);
  }
  std::string startOf(double z) const {
    return binary_ ? littleEndianBytes(127, 2) + real(z) : fmt::format("$$LAYER/{}\n", z);
  }
  void write(const std::string& text) { file_.write(text.data(), text.size()); }

  const PrintInfo info_;
  bool binary_;
  AtomicFile file_;
  std::uint64_t bytes_ = 0;
};

} // namespace

std::unique_ptr<LayerWriter> writeCli(const PrintInfo& info) {
  return std::make_unique<CliWriter>(info, false);
}
std::unique_ptr<LayerWriter> writeCliBinary(const PrintInfo& info) {
  return std::make_unique<CliWriter>(info, true);
}

} // namespace tetvdb
