// SPDX-License-Identifier: Apache-2.0
//
// Computes the shares of a layer's pixels from the contributions of its boundary, pixel by pixel.
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

/// Sums are integers in units of 2^-46 pixel, so that they do not depend on the order of
/// contributions. Cost: 24 bytes and about 20 ns per contribution; nothing for other pixels. Not
/// thread-safe.
class PixelSums {
public:
  void clear() { events_.clear(); }

  /// The boundary within pixel (x, y), seen along x: `cover` is its area, above 0 if the solid is
  /// on the side of larger x, relative to a pixel's side; `share` the volume between it and the
  /// pixel's end at x + 1, with the same sign, relative to a pixel.
  void add(std::int32_t x, std::int32_t y, double cover, double share);

  /// Writes rows of grey levels into `layer`, which is cleared first. Shares are limited to 0 to 1.
  /// Throws std::logic_error if the boundary is not closed.
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
