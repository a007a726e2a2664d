// SPDX-License-Identifier: Apache-2.0
//
// Small stacks of layers as dense arrays, to compare sweeps with what flood fills find.
#pragma once

#include "tetvdb/print/LayerComponents.h"
#include "tetvdb/print/LayerSource.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

namespace tetvdb {

/// Voxels (x, y, z); outside of the box all are void.
struct DenseStack {
  std::int32_t width = 0, height = 0, layers = 0;
  std::vector<std::uint8_t> solid;

  DenseStack(std::int32_t w, std::int32_t h, std::int32_t n)
      : width(w), height(h), layers(n),
        solid(static_cast<std::size_t>(std::int64_t(w) * h * n), 0) {}
  std::size_t index(std::int32_t x, std::int32_t y, std::int32_t z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(height) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  bool has(std::int32_t x, std::int32_t y, std::int32_t z) const {
    return x >= 0 && y >= 0 && z >= 0 && x < width && y < height && z < layers;
  }
  bool at(std::int32_t x, std::int32_t y, std::int32_t z) const {
    return has(x, y, z) && solid[index(x, y, z)] != 0;
  }
  void fill(std::array<std::int32_t, 3> low, std::array<std::int32_t, 3> end, bool value) {
    for (std::int32_t z = low[2]; z < end[2]; ++z)
      for (std::int32_t y = low[1]; y < end[1]; ++y)
        for (std::int32_t x = low[0]; x < end[0]; ++x)
          solid[index(x, y, z)] = value;
  }
  SpanRows rows(std::int32_t z) const {
    SpanRows result;
    for (std::int32_t y = 0; y < height; ++y)
      for (std::int32_t x = 0; x < width; ++x)
        if (at(x, y, z))
          result.add(y, x, x + 1);
    return result;
  }
};

/// Solid with the probability `share`; blurred so that bodies and cavities of some size come about.
inline DenseStack randomStack(std::mt19937& random, std::int32_t w, std::int32_t h, std::int32_t n,
                              double share) {
  DenseStack stack(w, h, n);
  std::bernoulli_distribution coin(share);
  for (std::uint8_t& voxel : stack.solid)
    voxel = coin(random);
  return stack;
}

/// The stack as a source of layers, with pixels of some size.
class DenseSource : public LayerSource {
public:
  DenseSource(const DenseStack& stack, double pixelWidth, double pixelHeight, double layerHeight)
      : stack_(stack) {
    frame_.width = stack.width;
    frame_.height = stack.height;
    frame_.layers = stack.layers;
    frame_.pixelWidth = pixelWidth;
    frame_.pixelHeight = pixelHeight;
    frame_.layerHeight = frame_.firstLayerHeight = layerHeight;
  }
  const LayerFrame& frame() const override { return frame_; }
  std::shared_ptr<const LayerBatch> batch(std::int32_t) override {
    return std::make_shared<Batch>(stack_);
  }

private:
  struct Batch : LayerBatch {
    explicit Batch(const DenseStack& stack) : stack_(stack) {}
    std::int32_t end() const override { return stack_.layers; }
    void make(std::int32_t k, Layer& layer) const override {
      layer.clear();
      for (std::int32_t y = 0; y < stack_.height; ++y)
        for (std::int32_t x = 0; x < stack_.width; ++x)
          layer.add(y, x, x + 1, stack_.at(x, y, k) ? 255 : 0);
    }
    const DenseStack& stack_;
  };

  DenseStack stack_;
  LayerFrame frame_;
};

} // namespace tetvdb
