// SPDX-License-Identifier: Apache-2.0
//
// Which faces every layer meets, a slab of layers at a time from below.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The layers that a face meets; none where last < first.
struct LayerRange {
  std::int32_t first = 0, last = -1;
};

/// The faces of consecutive layers.
struct LayerSlab {
  std::int32_t first = 0;
  std::vector<std::size_t> starts; ///< of each layer in `faces`, and the end
  std::vector<std::uint32_t> faces;

  std::int32_t end() const { return first + static_cast<std::int32_t>(starts.size()) - 1; }
};

/// Walks upward. A slab has as many layers as hold `pairsInSlab` pairs of a face and a layer, at
/// least one. Memory: 12 bytes a face, and 4 a pair of a slab. For one thread at a time.
class LayerFaces {
public:
  static constexpr std::size_t kPairsInSlab = std::size_t(1) << 22;

  LayerFaces(std::vector<LayerRange> ranges, std::int32_t layers,
             std::size_t pairsInSlab = kPairsInSlab);

  /// The next slab; layers that no face meets are in it. Not to be called beyond the last layer.
  LayerSlab next();
  std::int32_t layers() const { return layers_; }

private:
  std::vector<LayerRange> ranges_;
  std::vector<std::uint32_t> order_;  ///< faces in order of their first layer
  std::vector<std::uint32_t> active_; ///< faces of layers before that reach at_
  std::vector<std::size_t> begins_;   ///< of each first layer in order_
  std::int32_t layers_ = 0, at_ = 0;
  std::size_t pairsInSlab_;
};

} // namespace tetvdb
