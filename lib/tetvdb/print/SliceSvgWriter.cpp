// SPDX-License-Identifier: Apache-2.0
//
// Format: SVG 1.1 with one group per layer and the attributes of Slic3r.
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/print/LayerFile.h"

#include <fmt/format.h>

namespace tetvdb {
namespace {

class SliceSvgWriter : public LayerWriter {
public:
  explicit SliceSvgWriter(const PrintInfo& info) : info_(info), file_(info.path) {
    const double width = info.printer.display[0];
    write(fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                      "<svg width=\"{0}mm\" height=\"{1}mm\" viewBox=\"0 0 {0} {1}\" "
                      "xmlns=\"http://www.w3.org/2000/svg\" "
                      "xmlns:slic3r=\"http://slic3r.org/namespaces/slic3r\" slic3r:type=\"FFF\">\n"
                      "  <rect width=\"{0}\" height=\"{1}\" fill=\"black\"/>\n",
                      width, height()));
  }

  EncodedLayer encode(std::int32_t k, const Layer& layer) const override {
    const LayerFrame& frame = info_.frame;
    const double top = frame.bottomOf(k + 1), thickness = frame.heightOf(k);
    std::string text = fmt::format("  <g id=\"layer{}\" slic3r:z=\"{}\" slic3r:slice-z=\"{}\" "
                                   "slic3r:layer-height=\"{}\">\n",
                                   k, top, frame.bottomOf(k) + thickness / 2, thickness);
    if (!layer.contours.empty()) {
      text += "    <path fill=\"white\" fill-rule=\"nonzero\" d=\"";
      for (const LayerContour& contour : layer.contours) {
        for (std::size_t i = 0; i < contour.size(); ++i) // y runs downward
          text +=
              fmt::format("{}{} {}", i == 0 ? "M" : "L", contour[i][0], height() - contour[i][1]);
        text += "Z";
      }
      text += "\"/>\n";
    }
    return {text + "  </g>\n", "", layer.filled, layer.overlap, layer.empty()};
  }

  void add(std::int32_t, const EncodedLayer& layer) override { write(layer.bytes); }

  void finish() override {
    write("</svg>\n");
    bytes_ = file_.size();
    file_.commit();
  }
  std::uint64_t bytes() const override { return bytes_; }

private:
  double height() const { return info_.printer.display[1]; }
  void write(const std::string& text) { file_.write(text.data(), text.size()); }

  const PrintInfo info_;
  AtomicFile file_;
  std::uint64_t bytes_ = 0;
};

} // namespace

std::unique_ptr<LayerWriter> writeSliceSvg(const PrintInfo& info) {
  return std::make_unique<SliceSvgWriter>(info);
}

} // namespace tetvdb
