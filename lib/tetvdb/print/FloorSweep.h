// SPDX-License-Identifier: Apache-2.0
//
// Floors and roofs: solid that is thin from below to above.
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

/// A pixel is in a thick column where the solid above and below it is as many layers high as the
/// limit is. Thin are the pixels of a layer that are farther than twice the limit from all pixels
/// of it in thick columns, between centres. So edges of 27 degrees and more are not thin. Memory:
/// some four times as many layers as the limit is high. Cost: about 10 ns a span and layer, times
/// the logarithm of the number of layers.
class FloorSweep {
public:
  /// Called for layers from 0 on, those without thin pixels too.
  using Take = std::function<void(std::int32_t k, SpanRows thin)>;

  /// `limit` in millimetres, rounded up to layers as high as those above the first.
  FloorSweep(const LayerFrame& frame, double limit, Take take);

  /// The next layer, from 0 on.
  void add(const SpanRows& solid);
  /// After the last layer.
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
  /// By p: what is in all of 2^p layers from that one on; what is in any of 2^p of the sets of
  /// columns that begin there.
  std::vector<Window> all_, any_;
  Window solid_;
};

} // namespace tetvdb
