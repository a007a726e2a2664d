// SPDX-License-Identifier: Apache-2.0
//
// Finds the faces that each layer meets, one slab of layers at a time from below.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The layers that a face meets; none if last < first.
struct LayerRange {
  std::int32_t first = 0, last = -1;
};

/// The faces of consecutive layers.
struct LayerSlab {
  std::int32_t first = 0;
  std::vector<std::size_t> starts; ///< by layer: its first entry in `faces`, and the end
  std::vector<std::uint32_t> faces;

  std::int32_t end() const { return first + static_cast<std::int32_t>(starts.size()) - 1; }
};

/// Iterates upward. A slab has as many layers as contain `pairsInSlab` pairs of a face and a layer,
/// at least one. Memory: 12 bytes per face, and 4 per pair of a slab. Not thread-safe.
class LayerFaces {
public:
  static constexpr std::size_t kPairsInSlab = std::size_t(1) << 22;

  LayerFaces(std::vector<LayerRange> ranges, std::int32_t layers,
             std::size_t pairsInSlab = kPairsInSlab);

  /// Returns the next slab, including layers without faces. Must not be called beyond the last
  /// layer.
  LayerSlab next();
  std::int32_t layers() const { return layers_; }

private:
  std::vector<LayerRange> ranges_;
  std::vector<std::uint32_t> order_;  ///< faces in order of their first layer
  std::vector<std::uint32_t> active_; ///< faces of previous layers that reach at_
  std::vector<std::size_t> begins_;   ///< by first layer: position in order_
  std::int32_t layers_ = 0, at_ = 0;
  std::size_t pairsInSlab_;
};

} // namespace tetvdb
