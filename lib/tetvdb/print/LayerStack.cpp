// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/LayerStack.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Report.h"

#include <algorithm>
#include <fmt/format.h>

namespace tetvdb {
namespace {

class LayerStack : public LayerWriter {
public:
  LayerStack(const LayerFrame& frame, std::vector<std::uint8_t>& pixels)
      : frame_(frame), pixels_(pixels) {
    pixels_.assign(layerSize() * static_cast<std::size_t>(frame.layers), 0);
  }

  EncodedLayer encode(std::int32_t k, const Layer& layer) const override {
    // Layers have separate bytes.
    std::uint8_t* image = pixels_.data() + layerSize() * static_cast<std::size_t>(k);
    for (std::size_t i = 0; i < layer.rows.size(); ++i) {
      std::uint8_t* row = image + static_cast<std::size_t>(layer.rows[i].y) *
                                      static_cast<std::size_t>(frame_.width);
      const auto [first, last] = layer.runsOf(i);
      for (const PixelRun* run = first; run != last; ++run)
        std::fill(row + run->begin, row + run->end, run->value);
    }
    EncodedLayer encoded;
    encoded.filled = layer.filled;
    encoded.overlap = layer.overlap;
    encoded.empty = layer.empty();
    return encoded;
  }
  void add(std::int32_t, const EncodedLayer&) override {}
  void finish() override {}
  std::uint64_t bytes() const override { return pixels_.size(); }

private:
  std::size_t layerSize() const {
    return static_cast<std::size_t>(frame_.width) * static_cast<std::size_t>(frame_.height);
  }

  const LayerFrame frame_;
  std::vector<std::uint8_t>& pixels_;
};

} // namespace

std::unique_ptr<LayerWriter> layerStack(const LayerFrame& frame, std::size_t maxMemory,
                                        std::vector<std::uint8_t>& pixels) {
  const double bytes = static_cast<double>(frame.width) * frame.height * frame.layers;
  const std::size_t limit = maxMemory > 0 ? maxMemory : availableBytes();
  if (limit > 0 && bytes > static_cast<double>(limit))
    throw Error(Status::Limit, "",
                fmt::format("all layers take {:.0f} MB, there are {:.0f}", bytes / 1e6,
                            static_cast<double>(limit) / 1e6),
                "write them to a file, raise `max_memory`, or use larger pixels");
  return std::make_unique<LayerStack>(frame, pixels);
}

} // namespace tetvdb
