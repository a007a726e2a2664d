// SPDX-License-Identifier: Apache-2.0
//
// The shares of a layer's pixels out of what its boundary adds, pixel by pixel.
//
//   tetvdb::PixelSums sums;
//   sums.add(3, 7, cover, share);      // of every pixel that the boundary passes through
//   sums.finish(levels, layer);
#pragma once

#include "tetvdb/print/GreyLevels.h"
#include "tetvdb/print/Layer.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// Sums are of whole numbers of 2^-46 pixel, so that they do not depend on the order of what is
/// added. Cost: 24 bytes and about 20 ns for each that is added; nothing for other pixels. For one
/// thread at a time.
class PixelSums {
public:
  void clear() { events_.clear(); }

  /// The boundary within pixel (x, y), seen along x: `cover` is its area, above 0 where the solid
  /// is on the side of larger x, as a part of a pixel's side; `share` the volume between it and the
  /// pixel's end at x + 1, signed likewise, as a part of a pixel.
  void add(std::int32_t x, std::int32_t y, double cover, double share);

  /// Rows of grey levels into `layer`, which is cleared first. Shares are clamped to 0 to 1. Throws
  /// std::logic_error where the boundary does not close.
  void finish(const GreyLevels& levels, Layer& layer);

private:
  struct Event {
    std::int32_t x, y;
    std::int64_t cover, share;
  };
  void sortByRow();

  std::vector<Event> events_, sorted_;
  std::vector<std::uint32_t> starts_;
};

} // namespace tetvdb
