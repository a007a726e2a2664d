// SPDX-License-Identifier: Apache-2.0
//
// Finds floors and roofs: solid that is thin in the vertical direction.
//
//   tetvdb::FloorSweep sweep(frame, 0.5, [](std::int32_t k, SpanRows thin) { ... });
//   for (k = 0; ...)
//     sweep.add(solid);
//   sweep.finish();
#pragma once

#include "tetvdb/print/Layer.h"
#include "tetvdb/print/NearPixels.h"
#include "tetvdb/print/SpanRows.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

namespace tetvdb {

/// A pixel is in a thick column if the solid above and below it is at least as high as the limit.
/// Thin are the pixels of a layer that are farther than twice the limit from all pixels of it in
/// thick columns, between centres. Edges of 27 degrees and more are therefore not thin. Memory:
/// about four times the layers of the limit. Cost: about 10 ns per span and layer, times the
/// logarithm of the number of layers.
class FloorSweep {
public:
  /// Is called for layers from 0, including those without thin pixels.
  using Take = std::function<void(std::int32_t k, SpanRows thin)>;

  /// `limit` in millimetres, rounded up to layers as high as those above the first.
  FloorSweep(const LayerFrame& frame, double limit, Take take);

  /// Adds the next layer, from 0.
  void add(const SpanRows& solid);
  /// To be called after the last layer.
  void finish();

private:
  // Sets of the last layers; the first is that of layer `first`.
  struct Window {
    std::deque<SpanRows> sets;
    std::int32_t first = 0;
    const SpanRows& at(std::int32_t k) const { return sets[static_cast<std::size_t>(k - first)]; }
    void push(SpanRows set, std::size_t keep);
  };
  void addThick(SpanRows whole);

  std::int32_t height_ = 1; ///< layers of the limit
  PixelDisc disc_;
  Take take_;
  std::int32_t k_ = 0, given_ = 0;
  /// By p: the intersection of 2^p layers from each layer on; the union of 2^p of the sets of
  /// columns that begin there.
  std::vector<Window> all_, any_;
  Window solid_;
};

} // namespace tetvdb
